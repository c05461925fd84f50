// Derivation. Let f_c(x) be the contact forces at the nodes, f_b those of the solid, K = K_b + K_c the tangent, and w a
// displacement that moves slave nodes only: by the unit vector d along the pair's force, or by d times a function that
// is 1 at the peak of the pressure and 0 where it has fallen to half. Then Q = w · f_c is the force along d, or the
// pressure around the peak times a fixed area. Its
// derivative is K_cᵀ w, so its influence field is
//   z = K⁻¹ K_c w = w − K⁻¹ K_b w
// (K symmetric, prescribed components zero), and K_b w are the forces of the linear solid at the displacement w: no
// derivative of the contact form is needed. Between nodes that carry no other loads Q is −w · f_b(u) = −u · K_b w.
#include "goal_errors.hpp"

#include "accuracy/goal_error.hpp"
#include "base/timer.hpp"
#include "math/reference_element.hpp"
#include "wall_clock.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

/// Pairs beyond which the figures are too many to ask for each unasked.
constexpr std::size_t most_pairs = 8;

/// Where the summary has the figures that the deck names.
const char* const mean_displacements = "mean_displacement";

using Direction = std::array<double, 3>;

std::string reason_against(const Scene& scene) {
  if (scene.contacts.empty() && scene.deck.figures.empty()) return "no contact, and the deck names no figures";
  if (!scene.bulk->tangent_is_constant()) return "only for linear elastic solids in small kinematics";
  if (scene.bounds || scene.conditions)
    return "not for `vi` and `semismooth` with the dual basis, which solve transformed systems";
  if (!scene.problem->tangent_is_symmetric()) return "not with friction: figures then depend on the whole path";
  if (scene.contacts.size() > most_pairs) return "more than " + std::to_string(most_pairs) + " pairs";
  return "";
}

/// Sum over ranks of the pair's traction; null vector where nothing presses.
Direction direction_of_force(MPI_Comm comm, const ContactSamples& samples) {
  Direction force{};
  for (std::size_t q = 0; q < samples.size(); ++q)
    for (std::size_t c = 0; c < 3; ++c)
      force[c] += samples.weight[q] * samples.pressure[q] * samples.normal[q][c];
  MPI_Allreduce(MPI_IN_PLACE, force.data(), 3, MPI_DOUBLE, MPI_SUM, comm);
  const double size = std::hypot(force[0], force[1], force[2]);
  for (double& component : force)
    component = size > 0.0 ? component / size : 0.0;
  return force;
}

/// Nodal pressure of a slave surface by local mesh node, the same on all ranks. Collective.
std::vector<double> nodal_pressures(const Mesh& mesh, const ContactPair& pair, const ContactSamples& samples) {
  const auto& nodes = mesh.node_groups.at(pair.slave);
  const NodeSpace space(mesh, {{pair.slave, nodes}});
  std::vector<double> pressures(mesh.num_local(), 0.0);
  for (std::size_t i = 0; i < samples.nodes.size(); ++i)
    pressures[samples.nodes[i]] = samples.nodal_pressure[i];
  std::vector<std::vector<double>> values(1);
  for (const auto node : nodes)
    values[0].push_back(node < mesh.num_owned ? pressures[node] : 0.0);
  const VecHandle all = space.new_vector();
  space.add(values, all);
  space.gather(all, values);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    pressures[nodes[i]] = values[0][i];
  return pressures;
}

/// How much a corner of the slave surface counts for the peak: 1 where the pressure is largest, down to 0 at half of
/// it, so that the figure is one of the solution and not of a node. Empty where nothing presses. Collective.
std::vector<double> peak_weights(MPI_Comm comm, std::span<const double> pressures) {
  double largest = 0.0;
  for (const double pressure : pressures)
    largest = std::max(largest, pressure);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, comm);
  if (largest == 0.0) return {};
  std::vector<double> weights;
  for (const double pressure : pressures)
    weights.push_back(std::max(0.0, 2.0 * pressure / largest - 1.0));
  return weights;
}

void take_prescribed_out(const Scene& scene, Vec vector) {
  VecArray values(vector);
  const PetscInt first = scene.layout->first_equation();
  for (PetscInt i = 0; i < values.size(); ++i)
    if (scene.problem->is_prescribed(first + i)) values[i] = 0.0;
}

/// The displacement w of one figure under assembly.
class Lifting {
 public:
  Lifting(const Scene& scene, const ContactPair& pair)
      : scene_(scene), facets_(scene.mesh.surfaces.at(pair.slave)), vector_(scene.layout->new_vector()) {}

  /// `direction` at all slave nodes.
  void move_all(const Direction& direction) {
    for (const auto node : facets_.nodes)
      set(node, direction, 1.0);
  }

  /// `direction` times the function of order 1 that has these values at the corners of facets.
  void move_by(std::span<const double> corner_values, const Direction& direction) {
    for (std::int32_t f = 0; f < facets_.size(); ++f) {
      const auto nodes = facets_.facet(f);
      const ElementType type = facets_.types[f], corners = linear_element(type);
      const auto dim = static_cast<std::size_t>(element_dim(type));
      std::vector<double> shape(num_nodes(corners));
      for (int b = 0; b < num_nodes(type); ++b) {
        shape_values(corners, reference_nodes(type).subspan(b * dim, dim), shape);
        double value = 0.0;
        for (int a = 0; a < num_nodes(corners); ++a)
          value += shape[a] * corner_values[nodes[a]];
        set(nodes[b], direction, value);
      }
    }
  }

  /// Collective.
  Vec finish() {
    AMT_PETSC(VecAssemblyBegin(vector_));
    AMT_PETSC(VecAssemblyEnd(vector_));
    take_prescribed_out(scene_, vector_);
    return vector_;
  }

 private:
  void set(std::int32_t node, const Direction& direction, double value) {
    for (int c = 0; c < scene_.mesh.dim; ++c)
      AMT_PETSC(VecSetValue(vector_, scene_.layout->equation(node, c), value * direction[c], INSERT_VALUES));
  }
  const Scene& scene_;
  const FacetSet& facets_;
  VecHandle vector_;
};

/// K_b w. Collective.
VecHandle solid_forces(Scene& scene, Vec unknowns) {
  VecHandle forces = scene.layout->new_vector();
  const auto state = scene.problem->state_at(unknowns);
  Residual residual(*scene.layout, forces);
  scene.bulk->add_residual(state, residual);
  residual.finish();
  return forces;
}

/// Adds the figure whose influence is `lift` − K⁻¹ `forces` (no lift: K⁻¹ forces); false where the linear solver fails.
/// Collective.
bool add_influence(Scene& scene, IncrementSolver& solver, Vec lift, Vec forces, FigureInfluences::Figure figure,
                   FigureInfluences& found) {
  const VecHandle response = scene.layout->new_vector();
  take_prescribed_out(scene, forces);
  // A residual of 1e-3 leaves the error of a force, a sum that nearly cancels, off by two thirds (hertz_3d with 106,000
  // unknowns), of 1e-4 by 1 %.
  if (!solver.solve_linearized(forces, 1e-4, response)) return false;
  if (lift) AMT_PETSC(VecAYPX(response, -1.0, lift));
  const auto field = scene.problem->state_at(response).displacement;
  figure.influence.assign(field.begin(), field.end());
  found.figures.push_back(std::move(figure));
  return true;
}

/// Of this lifting; `figure` has its names.
bool ask(Scene& scene, IncrementSolver& solver, Lifting& lifting, FigureInfluences::Figure figure,
         FigureInfluences& found) {
  const Vec lift = lifting.finish();
  const VecHandle forces = solid_forces(scene, lift);
  PetscScalar work = 0.0;
  AMT_PETSC(VecDot(forces, solver.accepted(), &work));
  if (work == 0.0) return true;
  figure.value = -work;
  return add_influence(scene, solver, lift, forces, std::move(figure), found);
}

/// A mean displacement: dQ/du is one over the number of nodes at each of them.
bool ask(Scene& scene, IncrementSolver& solver, const std::string& name, const FigureDeck& figure,
         FigureInfluences& found) {
  const VecHandle weights = scene.layout->new_vector();
  double count = 0.0;
  const auto& nodes = scene.mesh.node_groups.at(figure.of.value);
  for (const auto node : nodes)
    if (node < scene.mesh.num_owned) {
      AMT_PETSC(VecSetValue(weights, scene.layout->equation(node, figure.component), 1.0, ADD_VALUES));
      count += 1.0;
    }
  AMT_PETSC(VecAssemblyBegin(weights));
  AMT_PETSC(VecAssemblyEnd(weights));
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_DOUBLE, MPI_SUM, scene.mesh.comm);
  AMT_PETSC(VecScale(weights, 1.0 / count));
  PetscScalar value = 0.0;
  AMT_PETSC(VecDot(weights, solver.accepted(), &value));
  if (value == 0.0) return true;
  return add_influence(scene, solver, nullptr, weights, {.pair = mean_displacements, .name = name, .value = value},
                       found);
}

} // namespace

FigureInfluences influences_on_figures(Scene& scene, IncrementSolver& solver, std::span<const ContactSamples> samples) {
  FigureInfluences found;
  found.reason = reason_against(scene);
  if (!found.reason.empty()) return found;
  const Phase phase("figure errors");
  const double begun = now();
  for (std::size_t i = 0; i < scene.contacts.size() && found.reason.empty(); ++i) {
    const auto& pair = scene.contacts[i]->pair();
    const auto direction = direction_of_force(scene.mesh.comm, samples[i]);
    const auto pressures = nodal_pressures(scene.mesh, pair, samples[i]);
    const auto weights = peak_weights(scene.mesh.comm, pressures);
    if (weights.empty()) continue;
    Lifting everywhere(scene, pair), around(scene, pair);
    everywhere.move_all(direction);
    around.move_by(weights, direction);
    const auto deviation = peak_deviation(scene.mesh, scene.mesh.surfaces.at(pair.slave), samples[i], pressures);
    if (!ask(scene, solver, everywhere, {.pair = pair.name, .name = "force"}, found) ||
        !ask(scene, solver, around, {.pair = pair.name, .name = "peak_pressure", .deviation = deviation}, found))
      found.reason = "the linear solver failed";
  }
  for (const auto& [name, figure] : scene.deck.figures)
    if (found.reason.empty() && !ask(scene, solver, name, figure, found)) found.reason = "the linear solver failed";
  found.seconds = now() - begun;
  return found;
}

FigureErrors estimate_figure_errors(Scene& scene, Vec unknowns, FigureInfluences found) {
  FigureErrors errors{.figures = {}, .reason = std::move(found.reason), .seconds = found.seconds};
  if (found.figures.empty()) return errors;
  const Phase phase("figure errors");
  const double begun = now();
  std::vector<std::vector<double>> influences;
  for (auto& figure : found.figures)
    influences.push_back(std::move(figure.influence));
  auto goals = estimate_goal_errors(*scene.bulk, scene.mesh, scene.problem->state_at(unknowns), influences);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const auto& figure = found.figures[i];
    const double size = std::abs(figure.value);
    auto& cells = goals[i].cells;
    for (double& cell : cells)
      cell /= size;
    errors.figures.push_back({.pair = figure.pair,
                              .figure = figure.name,
                              .value = figure.value,
                              .relative = goals[i].error / figure.value,
                              .deviation = figure.deviation,
                              .bound = goals[i].bound / size + figure.deviation,
                              .cells = std::move(cells)});
  }
  errors.seconds += now() - begun;
  return errors;
}

nlohmann::ordered_json to_json(const FigureErrors& errors, double run_seconds) {
  nlohmann::ordered_json json;
  for (const auto& figure : errors.figures) {
    auto& entry = json[figure.pair][figure.figure];
    if (figure.pair == mean_displacements) entry["value"] = figure.value;
    entry["relative"] = figure.relative;
    if (figure.deviation > 0.0) entry["of_linear_pressure"] = figure.deviation;
    entry["without_cancelling"] = figure.bound;
  }
  if (!errors.reason.empty()) json["reason"] = "not estimated: " + errors.reason;
  json["meaning"] = "exact less computed figure over the computed one, estimated: error of the stress weighed by the "
                    "influence of each cell on the figure (dual weighted residual, recovered stresses); "
                    "peak_pressure: the weighted mean of the pressure where it is more than half of its largest; "
                    "of_linear_pressure: what a pressure that is linear on facets may be off at the peak's node, with "
                    "either sign; without_cancelling: the sum of all parts without their signs";
  json["cost"] = {{"seconds", errors.seconds}, {"share_of_time", errors.seconds / std::max(run_seconds, 1e-12)}};
  return json;
}

} // namespace amontons
