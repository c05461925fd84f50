// What a run tells about itself: rows of the history, fields, summary. Reads the scene, changes nothing.
#pragma once

#include "ledger.hpp"
#include "output/fields.hpp"
#include "scene.hpp"
#include "solve/ladder.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace amontons {

/// Numbers of a row of history.csv besides those that the scene knows.
struct IncrementReport {
  double time = 0.0;
  SolveOutcome outcome;
  double path_error = 0.0; // of the increment that ends here; zero if not measured
  bool certified = false;
};

std::vector<std::string> history_columns(const Scene& scene, const Ledger& ledger);
/// One number per column. Collective.
std::vector<double> history_row(Scene& scene, const Ledger& ledger, const std::vector<ContactTotals>& totals,
                                const IncrementReport& report);

/// Writes the fields that the deck asks for. Collective.
void write_fields(Scene& scene, FieldsWriter& writer, Vec unknowns, const std::vector<ContactSamples>& samples);

/// Seconds per phase (mean over ranks), CPU seconds and peak memory (sums over ranks). Collective.
nlohmann::ordered_json resources(MPI_Comm comm, double wall_seconds);
/// What each pair transmits at the end of the run; of frictional pairs also the shear force, the areas that stick,
/// slide and are open, and the dissipation since the start.
nlohmann::ordered_json contact_results(const Scene& scene, const Ledger& ledger,
                                       const std::vector<ContactTotals>& totals);
/// How often each remedy was tried and helped; nothing if none was tried.
nlohmann::ordered_json describe_remedies(const std::vector<Ladder::Use>& uses);
/// Cycle, points that flip and bodies that nothing holds, for programs to read.
nlohmann::ordered_json describe_trouble(const Trouble& trouble);
/// Sizes, effects on and off, pairs and how they are enforced. Collective.
nlohmann::ordered_json describe_scene(const Scene& scene);

} // namespace amontons
