// Errors of the figures that are asked for most, each pair's force and largest pressure, and of those that the deck
// names, from the influence of every cell on them: `errors.figures` of the summary.
#pragma once

#include "accuracy/followed_peak.hpp"
#include "increment_solver.hpp"
#include "scene.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace amontons {

/// A figure of the last accepted state with what the mesh makes of it.
struct FigureError {
  std::string pair, figure;  // "force" (its size), "peak_pressure" (mean of the pressure above half of the largest)
  double value = 0.0;        // of a mean displacement; else in a unit of its own
  double relative = 0.0;     // (exact − computed) / computed, estimated, with its sign
  double deviation = 0.0;    // of a peak: what linear pressures may be off at its node, >= 0 (peak_deviation)
  double bound = 0.0;        // |exact − computed| / |computed| if no parts cancelled: of the cells, and the deviation
  std::vector<double> cells; // |part| of this rank's cells, over the figure
};

/// Figures whose influence fields are known.
struct FigureInfluences {
  struct Figure {
    std::string pair, name;
    double value = 0.0;                 // in the unit of the influence
    std::vector<double> influence = {}; // displacement, num_local x dim
    double deviation = 0.0;             // of a peak
  };
  std::vector<Figure> figures;
  std::string reason; // why there are none, in words; else empty
  double seconds = 0.0;
};

/// Of the last accepted state; `samples`: of that state, one a pair. Where the solid is linear elastic, nothing rubs,
/// and a linear system with the tangent is a matter of a back-substitution; elsewhere it says why not. Collective.
FigureInfluences influences_on_figures(Scene& scene, IncrementSolver& solver, std::span<const ContactSamples> samples);

struct FigureErrors {
  std::vector<FigureError> figures;
  std::string reason; // as above
  double seconds = 0.0;
};

/// `unknowns`: the state of the influences. Needs no solver. Collective.
FigureErrors estimate_figure_errors(Scene& scene, Vec unknowns, FigureInfluences influences);

nlohmann::ordered_json to_json(const FigureErrors& errors, double run_seconds);

} // namespace amontons
