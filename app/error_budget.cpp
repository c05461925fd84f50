#include "error_budget.hpp"

#include "accuracy/kinematics_audit.hpp"
#include "base/log.hpp"
#include "base/timer.hpp"
#include "wall_clock.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

using Json = nlohmann::ordered_json;

/// Where the terms that small kinematics leave out are more than this part of the largest strain, strains are off by as
/// much. A choice: what is usual as accuracy of a stress analysis.
constexpr double most_neglected = 0.05;

Json cost(double seconds, const BudgetInput& input) {
  return {{"seconds", seconds}, {"share_of_time", seconds / std::max(input.wall_seconds, 1e-12)}};
}

double seconds_of_phase(const char* phase) {
  const auto& seconds = PhaseTimer::of_run().seconds();
  const auto found = seconds.find(phase);
  return found == seconds.end() ? 0.0 : found->second;
}

Json discretization(const BudgetInput& input) {
  const auto& error = input.mesh_error;
  Json json = {{"relative", error.relative()}, {"energy_norm", error.error}};
  if (error.near_edge > 0.0) {
    json["relative_near_contact_edge"] = error.relative_near_edge();
    json["share_near_contact_edge"] = error.edge_share();
  }
  json["norm"] = input.scene.bulk->tangent_is_constant() ? "energy" : "stress in L2";
  json["meaning"] = "error of the stress at the end, by patch recovery (Zienkiewicz and Zhu, 1992), in the given norm, "
                    "relative to that of the solution; the same for the cells within a facet of a change of status "
                    "alone; the share is that of these cells in the square of the whole; stress in L2: of Cauchy's "
                    "stress over E, an indicator where the material is not linear elastic";
  json["cost"] = cost(seconds_of_phase("error estimate"), input);
  return json;
}

Json path(const BudgetInput& input) {
  if (!input.path) return {{"relative", nullptr}, {"meaning", "not measured: the deck does not ask for it"}};
  const Json record = input.path->to_json();
  return {{"relative", record.at("estimated_error")},
          {"meaning", "see `path`"},
          {"cost", cost(record.at("extra_seconds").get<double>(), input)}};
}

Json constraint(const BudgetInput& input) {
  if (input.scene.contacts.empty()) return {{"meaning", "no contact"}};
  const Json items = input.certificate.to_json().at("items");
  return {{"penetration", items.at("penetration").at("worst")},
          {"complementarity", items.at("complementarity").at("worst")},
          {"meaning", "largest of all increments, found by the certificate: penetration relative to the facet, "
                      "pressure across open gaps relative to force times facet"},
          {"cost", cost(seconds_of_phase("certificate"), input)}};
}

} // namespace

DiscretizationError estimate_mesh_error(Scene& scene, Vec unknowns, std::span<const ContactSamples> samples) {
  const Phase phase("error estimate");
  const auto state = scene.problem->state_at(unknowns);
  std::vector<std::string> slaves;
  for (const auto* contact : scene.contacts)
    slaves.push_back(contact->pair().slave);
  const auto edge = contact_edge(scene.mesh, state.displacement, slaves, samples);
  return estimate_discretization_error(*scene.bulk, scene.mesh, state, edge);
}

UnsolvedPart estimate_unsolved_part(Scene& scene, IncrementSolver& solver) {
  UnsolvedPart part;
  if (!scene.bulk->tangent_is_constant() || !scene.problem->tangent_is_symmetric()) return part;
  const Phase phase("algebra error");
  const double begun = now();
  const VecHandle residual = scene.layout->new_vector(), correction = scene.layout->new_vector();
  const bool is_solved =
      scene.problem->residual(solver.accepted(), residual) && solver.solve_linearized(residual, 1e-1, correction);
  const double all = scene.internal_work(solver.accepted());
  if (is_solved && all > 0.0) {
    PetscScalar work = 0.0;
    AMT_PETSC(VecDot(residual, correction, &work));
    part.relative = std::sqrt(std::abs(work) / all);
  }
  part.seconds = now() - begun;
  return part;
}

Json error_budget(const BudgetInput& input) {
  return {
      {"discretization", discretization(input)},
      {"figures", to_json(input.figures, input.wall_seconds)},
      {"path", path(input)},
      {"constraint", constraint(input)},
      {"algebra",
       {{"relative", input.largest_residual},
        {"energy_norm", input.unsolved.relative ? Json(*input.unsolved.relative) : Json()},
        {"meaning", "relative: largest out-of-balance force that the solver has left in an increment, over the forces "
                    "that are balanced; energy_norm: distance of the last state from the exact solution of its "
                    "discrete equations, over that of the solution (null: not for this formulation)"},
        {"cost", cost(input.unsolved.seconds, input)}}}};
}

std::string budget_sentence(const Json& budget) {
  const auto& mesh = budget.at("discretization");
  std::string line = formatted("errors: mesh about %.2g %% in %s", 100 * mesh.at("relative").get<double>(),
                               mesh.at("norm") == "energy" ? "the energy norm" : "the stress (L2)");
  if (mesh.contains("share_near_contact_edge"))
    line += formatted(" (%.0f %% of its square at the edge of contact)",
                      100 * mesh.at("share_near_contact_edge").get<double>());
  for (const auto& [pair, figures] : budget.at("figures").items())
    if (figures.is_object() && figures.contains("peak_pressure"))
      line += formatted(", peak pressure of %s %.2g %%", pair.c_str(),
                        100 * figures.at("peak_pressure").at("without_cancelling").get<double>());
  const auto& steps = budget.at("path").at("relative");
  line += steps.is_null() ? ", increments not measured" : formatted(", increments %.2g %%", 100 * steps.get<double>());
  if (budget.at("constraint").contains("penetration"))
    line += formatted(", penetration %.1e of a facet", budget.at("constraint").at("penetration").get<double>());
  return line + formatted(", residual force %.1e", budget.at("algebra").at("relative").get<double>());
}

Json audit_effects(const Scene& scene, Vec unknowns) {
  if (scene.deck.kinematics == Kinematics::Finite) return {{"finite_kinematics", {{"on", true}}}};
  const Phase phase("error estimate");
  const auto state = scene.problem->state_at(unknowns);
  const auto audit = audit_kinematics(scene.mesh, scene.deck.space, state.displacement);
  return {{"finite_kinematics",
           {{"on", false},
            {"indicator", audit.ratio()},
            {"threshold", most_neglected},
            {"above_threshold", audit.ratio() > most_neglected},
            {"largest_rotation", audit.rotation},
            {"largest_strain", audit.strain},
            {"meaning", "largest term of the Green-Lagrange strain that small kinematics leave out, over the largest "
                        "strain (Bathe, Finite Element Procedures, section 6.2.2); where rotations are larger than "
                        "strains it grows with their square"}}}};
}

std::vector<std::string> audit_warnings(const Json& effects) {
  std::vector<std::string> lines;
  for (const auto& [name, effect] : effects.items())
    if (effect.value("above_threshold", false))
      lines.push_back(formatted("%s is off, but its indicator is %.2g, above %.2g: see `effects` in the summary",
                                name.c_str(), effect.at("indicator").get<double>(),
                                effect.at("threshold").get<double>()));
  return lines;
}

} // namespace amontons
