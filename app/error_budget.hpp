// What a run says at its end about its own accuracy: the size of each kind of error with what it cost to know it, and
// whether effects that are off should have been on.
#pragma once

#include "accuracy/discretization_error.hpp"
#include "certify.hpp"
#include "goal_errors.hpp"
#include "path_record.hpp"
#include "scene.hpp"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// The error of the mesh in a state that has just been accepted or is about to be, with the samples of that state.
/// Collective.
DiscretizationError estimate_mesh_error(Scene& scene, Vec unknowns, std::span<const ContactSamples> samples);

/// What the tolerances of the solvers have left in the last accepted state.
struct UnsolvedPart {
  /// Distance from the exact solution of the discrete equations in the energy norm, sqrt(r · K⁻¹ r), over that of the
  /// solution. Absent where there is no linear system at hand (see IncrementSolver::solve_linearized), with friction,
  /// and where the solid is not linear elastic.
  std::optional<double> relative;
  double seconds = 0.0;
};
/// Takes one more solve with the tangent. Collective.
UnsolvedPart estimate_unsolved_part(Scene& scene, IncrementSolver& solver);

/// The last accepted state, and what the run has gathered on its way there.
struct BudgetInput {
  Scene& scene;
  Vec unknowns;
  const DiscretizationError& mesh_error;
  const FigureErrors& figures;
  const CertificateRecord& certificate;
  const PathRecord* path;  // null: not measured
  double largest_residual; // of all accepted increments, relative to the force scale
  UnsolvedPart unsolved;
  double wall_seconds;
};

/// `errors` of the summary: discretization, figures, path, constraint and algebra. Collective.
nlohmann::ordered_json error_budget(const BudgetInput& input);
/// The budget in a sentence.
std::string budget_sentence(const nlohmann::ordered_json& budget);

/// `effects` of the summary: of what is off, an indicator with its threshold. Collective.
nlohmann::ordered_json audit_effects(const Scene& scene, Vec unknowns);
/// A sentence for each indicator above its threshold.
std::vector<std::string> audit_warnings(const nlohmann::ordered_json& effects);

} // namespace amontons
