// The multipliers are the lumped L2 projection of the traction, λ_i ∫ N_i = ∫ N_i σ: an average of numbers <= 0, so a
// nodal multiplier is never tensile, also at the edge of contact. (With the consistent mass it overshoots there.) What
// the lumping does to the constraint is that ε ∫ N_i g equals (lumped − consistent mass) λ, of order h² λ'' and zero
// for uniform pressure.
//
// Scaling of unknown multipliers. With traction λ = s μ, s one number per pair (force / volume, the mean of ε), μ has
// the unit of a displacement and its equation that of a force; so norms over all equations mean something and nothing
// depends on the units. u and μ rows are the derivatives of
//   Π(u, μ) = ∫ min(0, λ + ε g)² / (2 ε) − Σ_i λ_i² ∫ N_i / (2 ε):
//   δu:  ∫ σ δg,    δμ_i:  s ∫ N_i (σ − λ_i) / ε,
// second derivatives (χ = 1 in contact, else 0):  uu: χ ε δg δg,  uμ: χ s δg N,  μμ: χ s² N N / ε − s² δ_ij N_i / ε.
// Symmetric.
#include "contact/contact_form.hpp"

#include "base/timer.hpp"
#include "contact/kernel.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Points whose gap is below this many facet sizes get a place in the matrix before they touch.
constexpr double coupling_reach = 1.5;

bool any_of_all(MPI_Comm comm, bool mine) {
  int any = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm);
  return any != 0;
}

} // namespace

NodeField multiplier_nodes(const Mesh& mesh, const std::string& pair, const std::string& slave) {
  NodeField field{.name = pair, .nodes = {}};
  for (const auto node : mesh.node_groups.at(slave))
    if (mesh.is_vertex[node]) field.nodes.push_back(node);
  return field;
}

ContactForm::ContactForm(const DofLayout& layout, ContactPair pair)
    : layout_(layout), pair_(std::move(pair)), nodes_(multiplier_nodes(layout.mesh(), pair_.name, pair_.slave)),
      space_(layout.mesh(), {nodes_}), position_(layout.mesh().num_local(), -1), points_(layout, pair_) {
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i)
    position_[nodes_.nodes[i]] = static_cast<std::int32_t>(i);
  const std::size_t n = points_.points().size();
  gap_.assign(n, 0.0);
  lambda_.assign(n, 0.0);
  augmented_.assign(n, 0.0);
  active_.assign(n, 0);
  coupled_.assign(n, 0);
  multipliers_.assign(nodes_.nodes.size(), 0.0);
  multipliers_old_ = multipliers_;
  for (std::size_t i = 0; i < n; ++i) {
    gap_[i] = points_.points()[i].gap0;
  }
  couple_near();
  if (master_turns())
    for (const auto& point : points_.points())
      normals_old_.push_back({.sigma = 0.0, .gap = point.gap0, .normal = point.normal, .jump = {}});

  double sums[2] = {0.0, 0.0};
  for (const auto& point : points_.points()) {
    sums[0] += point.epsilon / pair_.alpha * point.weight;
    sums[1] += point.weight;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, layout.mesh().comm);
  scale_ = sums[0] / sums[1];
  if (is_unknown()) {
    const int field = std::get<Semismooth>(pair_.enforcement).field;
    std::vector<PetscInt> equations;
    for (const auto node : nodes_.nodes)
      equations.push_back(layout.extra_equation(field, node));
    const auto size = static_cast<PetscInt>(equations.size());
    IsHandle from;
    AMT_PETSC(ISCreateGeneral(layout.mesh().comm, size, equations.data(), PETSC_COPY_VALUES, from.put()));
    AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, local_multipliers_.put()));
    const auto global = layout.new_vector();
    AMT_PETSC(VecScatterCreate(global, from, local_multipliers_, nullptr, multiplier_scatter_.put()));
  }
  if (pair_.friction)
    tangential_ = std::make_unique<TangentialPart>(layout_, pair_, points_, nodes_, position_, scale_);
}

std::vector<ContactForm::Group> ContactForm::groups() const {
  std::vector<Group> all;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t old =
        tangential_ && tangential_->path() ? tangential_->path()->old_facet(i) : ContactPoint::none;
    if (all.empty() || all.back().facet != points[i].facet || all.back().master != points[i].master ||
        all.back().old_master != old)
      all.push_back({i, i, points[i].facet, points[i].master, old});
    all.back().end = i + 1;
  }
  return all;
}

// --- state at a point
// --------------------------------------------------------------------------------------------------

double ContactForm::gap_at(const ContactPoint& point, const State& state) const {
  if (point.master == ContactPoint::none || points_.is_following()) return point.gap0;
  const auto jump = points_.displacement_jump(point, state); // a rigid master's motion is in gap0
  return point.gap0 + point.normal[0] * jump[0] + point.normal[1] * jump[1] + point.normal[2] * jump[2];
}

double ContactForm::multiplier_at(const ContactPoint& point) const {
  const auto nodes = points_.slave().facet(point.facet);
  const auto shape = points_.multiplier_shape(point);
  double lambda = 0.0;
  for (std::size_t a = 0; a < shape.size(); ++a)
    lambda += shape[a] * multipliers_[position_[nodes[a]]];
  return lambda;
}

/// Gap, λ, λ̂ and status of all points. Collective.
void ContactForm::evaluate(const State& state) {
  if (points_.has_rigid_master() && state.time != rigid_time_) {
    points_.move_rigid_master(state.time);
    rigid_time_ = state.time;
  }
  if (points_.is_following())
    points_.follow(state);
  else if (points_.master())
    points_.master()->refresh(state.unknowns);
  fetch_multipliers(state);
  const auto& points = points_.points();
  bool touches = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    gap_[i] = gap_at(points[i], state);
    lambda_[i] = has_multipliers() ? multiplier_at(points[i]) : 0.0;
    augmented_[i] = augmented_traction(lambda_[i], points[i].epsilon, gap_[i]);
    active_[i] = points[i].master != ContactPoint::none && normal_traction_derivative(augmented_[i]) > 0.0;
    touches = touches || active_[i];
  }
  if (state.first_guess && !any_of_all(layout_.mesh().comm, touches))
    guess_contact(pair_.holds_floating_body && !was_moved_);
  if (!holds_.empty()) apply_holds();
  if (tangential_) evaluate_friction(state);
}

void ContactForm::evaluate_friction(const State& state) {
  normal_traction_.resize(active_.size());
  for (std::size_t i = 0; i < active_.size(); ++i)
    normal_traction_[i] = sigma(i);
  tangential_->evaluate(state, normal_traction_, active_);
}

/// Has anything of the slave been displaced, and of a meshed master? Collective.
bool ContactForm::both_moved(std::span<const double> displacement) const {
  const auto& mesh = layout_.mesh();
  const auto moved = [&](const std::string& surface) {
    const auto& nodes = mesh.node_groups.at(surface);
    const auto is_displaced = [&](std::int32_t node) {
      const auto u = displacement.subspan(std::size_t(node) * mesh.dim, mesh.dim);
      return std::any_of(u.begin(), u.end(), [](double component) { return component != 0.0; });
    };
    return any_of_all(mesh.comm, !displacement.empty() && std::any_of(nodes.begin(), nodes.end(), is_displaced));
  };
  const auto* master = std::get_if<std::string>(&pair_.master);
  const bool slave_moved = moved(pair_.slave);
  return master ? moved(*master) && slave_moved : slave_moved;
}

/// Nothing touches: take the points where the surfaces are nearest for closed, for one residual and one tangent, when
/// the surfaces (nearly) touch, or `at_any_distance` for a body that has nothing else to hold it. The next iteration
/// decides by the true test. A body that has moved and was in equilibrium
/// without this pair is held by another one; closing this one would throw the first iterate far off.
void ContactForm::guess_contact(bool at_any_distance) {
  const auto& points = points_.points();
  double nearest = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i)
    nearest = std::min(nearest, gap_[i] / points[i].size);
  MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE, MPI_MIN, layout_.mesh().comm);
  if (nearest > guess_reach && !at_any_distance) return;
  for (std::size_t i = 0; i < points.size(); ++i)
    active_[i] = points[i].master != ContactPoint::none && gap_[i] / points[i].size <= nearest + guess_reach;
}

// --- coupling
// ------------------------------------------------------------------------------------------------------------

bool ContactForm::coupled(const Group& group) const {
  return group.master >= 0 &&
         std::any_of(coupled_.begin() + static_cast<std::ptrdiff_t>(group.begin),
                     coupled_.begin() + static_cast<std::ptrdiff_t>(group.end), [](std::uint8_t c) { return c != 0; });
}

void ContactForm::couple_near() {
  if (points_.is_following()) return couple_near_now();
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (active_[i] || (points[i].master >= 0 && gap_[i] < coupling_reach * points[i].size)) coupled_[i] = 1;
}

/// Slave displacements, then unknown multipliers (normal, then tangential).
void ContactForm::gather_slave_equations(std::int32_t facet, std::vector<PetscInt>& equations) const {
  const int d = layout_.dim();
  equations.clear();
  const auto nodes = points_.slave().facet(facet);
  for (const auto node : nodes)
    for (int c = 0; c < d; ++c)
      equations.push_back(layout_.equation(node, c));
  if (is_unknown()) {
    const int field = std::get<Semismooth>(pair_.enforcement).field;
    for (int a = 0; a < num_vertices(points_.slave().types[facet]); ++a)
      equations.push_back(layout_.extra_equation(field, nodes[a]));
  }
  if (tangential_) tangential_->gather_multiplier_equations(facet, equations);
}

/// Those of the slave, then master displacements where the group is coupled.
void ContactForm::gather_equations(const Group& group, std::vector<PetscInt>& equations) const {
  gather_slave_equations(group.facet, equations);
  if (coupled(group))
    for (const auto node : points_.master()->stencil(group.master)) {
      const auto of_node = points_.master()->equations(node);
      equations.insert(equations.end(), of_node.begin(), of_node.end());
    }
}

void ContactForm::couple(Coupling& coupling) const {
  if (points_.is_following()) return couple_now(coupling);
  std::vector<PetscInt> equations;
  for (const auto& group : groups()) {
    gather_equations(group, equations);
    coupling.add(equations);
  }
}

bool ContactForm::coupling_changed(const State& state) {
  evaluate(state);
  bool missing = points_.is_following() && !all_coupled_now();
  for (std::size_t i = 0; i < active_.size() && !points_.is_following(); ++i)
    missing = missing || (active_[i] && points_.points()[i].master >= 0 && !coupled_[i]);
  if (missing) couple_near();
  return missing;
}

bool ContactForm::tangent_changed(const State& state) {
  if (points_.is_following()) return true;
  evaluate(state);
  return !assembled_ || active_ != assembled_active_ || (tangential_ && tangential_->tangent_changed());
}

// --- assembly
// ------------------------------------------------------------------------------------------------------------

/// ∂g/∂(equations of the group), zero at multipliers.
void ContactForm::gap_variation(const ContactPoint& point, const Group& group, std::span<double> variation) const {
  const int d = layout_.dim();
  std::fill(variation.begin(), variation.end(), 0.0);
  const auto shape = points_.slave_shape(point);
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < d; ++c)
      variation[a * d + c] = point.normal[c] * shape[a];
  if (!coupled(group)) return;
  const std::size_t masters = points_.master()->stencil(group.master).size();
  const std::size_t first = variation.size() - masters * d;
  for (std::size_t b = 0; b < masters; ++b)
    for (int c = 0; c < d; ++c)
      variation[first + b * d + c] = -point.normal[c] * point.master_shape[b];
}

void ContactForm::add_residual(const State& state, Residual& residual) {
  evaluate(state);
  if (points_.has_gone_through())
    residual.fail("pair '" + pair_.name + "': a wall has gone through another one that was in front of it");
  const auto& points = points_.points();
  const int d = layout_.dim();
  std::vector<PetscInt> equations;
  std::vector<double> values;
  for (const auto& group : groups()) {
    const bool any_active =
        std::any_of(active_.begin() + static_cast<std::ptrdiff_t>(group.begin),
                    active_.begin() + static_cast<std::ptrdiff_t>(group.end), [](std::uint8_t a) { return a != 0; });
    const auto nodes = points_.slave().facet(group.facet);
    if (any_active) {
      // Slave forces are local; the master may be on another rank and may not be in the matrix pattern yet.
      equations.clear();
      if (group.master >= 0)
        for (const auto node : points_.master()->stencil(group.master)) {
          const auto of_node = points_.master()->equations(node);
          equations.insert(equations.end(), of_node.begin(), of_node.end());
        }
      values.assign(equations.size(), 0.0);
      for (std::size_t i = group.begin; i < group.end; ++i) {
        const double force = sigma(i) * points[i].weight;
        const auto shape = points_.slave_shape(points[i]);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int c = 0; c < d; ++c)
            residual.nodal()[std::size_t(nodes[a]) * d + c] += force * points[i].normal[c] * shape[a];
        for (std::size_t k = 0; k < values.size(); ++k)
          values[k] -= force * points[i].normal[k % d] * points[i].master_shape[k / d];
      }
      residual.add(equations, values);
    }
    if (tangential_) tangential_->add_residual(group.begin, group.end, residual);
    if (points_.is_following()) add_turning_forces(group, residual);
    if (!is_unknown()) continue;
    const int field = std::get<Semismooth>(pair_.enforcement).field;
    const int vertices = num_vertices(points_.slave().types[group.facet]);
    equations.clear();
    for (int a = 0; a < vertices; ++a)
      equations.push_back(layout_.extra_equation(field, nodes[a]));
    values.assign(vertices, 0.0);
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const auto shape = points_.multiplier_shape(points[i]);
      const double factor = scale_ / points[i].epsilon * points[i].weight;
      for (int a = 0; a < vertices; ++a)
        values[a] += factor * shape[a] * multiplier_defect_at(i, position_[nodes[a]]);
    }
    residual.add(equations, values);
  }
}

/// Where the parts of gather_equations stand.
ContactBlock ContactForm::block_layout(const Group& group, std::size_t size) const {
  const int d = layout_.dim();
  ContactBlock block{.size = size, .normal_multipliers = -1, .tangential_multipliers = -1, .master = -1};
  if (is_unknown()) {
    block.normal_multipliers = static_cast<std::ptrdiff_t>(points_.slave().facet(group.facet).size()) * d;
    block.tangential_multipliers = block.normal_multipliers + num_vertices(points_.slave().types[group.facet]);
  }
  if (coupled(group))
    block.master = static_cast<std::ptrdiff_t>(size) -
                   static_cast<std::ptrdiff_t>(points_.master()->stencil(group.master).size()) * d;
  return block;
}

void ContactForm::add_tangent(const State& state, Tangent& tangent) {
  evaluate(state);
  assembled_active_ = active_;
  assembled_ = true;
  if (tangential_) tangential_->remember_tangent(state.first_guess);
  if (points_.is_following()) return add_tangent_now(state.first_guess, tangent);
  const auto& points = points_.points();
  std::vector<PetscInt> equations;
  std::vector<double> block, variation;
  for (const auto& group : groups()) {
    gather_equations(group, equations);
    const std::size_t n = equations.size();
    const std::size_t first = points_.slave().facet(group.facet).size() * layout_.dim();
    block.assign(n * n, 0.0);
    variation.resize(n);
    bool any = false;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const auto& point = points[i];
      const auto shape = points_.multiplier_shape(point);
      const double mm = point.weight * scale_ * scale_ / point.epsilon;
      if (is_unknown()) {
        any = true;
        for (std::size_t a = 0; a < shape.size(); ++a)
          block[(first + a) * (n + 1)] -= mm * shape[a];
      }
      if (!active_[i]) continue;
      any = true;
      gap_variation(point, group, variation);
      const double uu = point.weight * point.epsilon;
      for (std::size_t r = 0; r < n; ++r)
        if (variation[r] != 0.0)
          for (std::size_t c = 0; c < n; ++c)
            block[r * n + c] += uu * variation[r] * variation[c];
      if (!is_sought()) continue;
      for (std::size_t a = 0; a < shape.size(); ++a) {
        for (std::size_t b = 0; b < shape.size(); ++b)
          block[(first + a) * n + first + b] += mm * shape[a] * shape[b];
        for (std::size_t r = 0; r < n; ++r) {
          const double coupling = point.weight * scale_ * shape[a] * variation[r];
          block[r * n + first + a] += coupling;
          block[(first + a) * n + r] += coupling;
        }
      }
    }
    if (tangential_)
      any = tangential_->add_tangent(group.begin, group.end, block_layout(group, n), state.first_guess, block) || any;
    if (any) tangent.add(equations, block);
  }
}

// --- history and multipliers -----------------------------------------------------------------------------------------

void ContactForm::commit(const State& state) {
  evaluate(state);
  remember(state);
  multipliers_old_ = multipliers_;
  was_moved_ = both_moved(state.displacement);
  if (tangential_) tangential_->commit(state);
}

void ContactForm::roll_back() {
  multipliers_ = multipliers_old_;
  if (tangential_) tangential_->roll_back();
  assembled_ = false;
}

ContactHistory ContactForm::accepted() const {
  ContactHistory history;
  history.multipliers = multipliers_old_;
  history.normals = normals_old_;
  if (points_.is_following()) history.displacement = points_.accepted_displacement();
  if (tangential_) tangential_->save(history);
  return history;
}

void ContactForm::restore(const ContactHistory& history) {
  multipliers_ = multipliers_old_ = history.multipliers;
  normals_old_ = history.normals;
  if (points_.is_following()) points_.restore(history.displacement);
  was_moved_ = both_moved(history.displacement);
  if (tangential_) tangential_->restore(history);
  assembled_ = false;
}

void ContactForm::multiplier_defect(const State& state, std::vector<double>& defect, std::vector<double>& mass) {
  evaluate(state);
  defect.assign(nodes_.nodes.size(), 0.0);
  mass.assign(nodes_.nodes.size(), 0.0);
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto nodes = points_.slave().facet(points[i].facet);
    const auto shape = points_.multiplier_shape(points[i]);
    const double weight = points[i].weight / points[i].epsilon;
    for (std::size_t a = 0; a < shape.size(); ++a) {
      const auto at = position_[nodes[a]];
      defect[at] += weight * shape[a] * (sigma(i) - multipliers_[at]);
      mass[at] += weight * shape[a];
    }
  }
}

double ContactForm::stored_energy(const State& state) {
  evaluate(state);
  double energy = 0.0;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    double square = 0.0;
    const auto nodes = points_.slave().facet(points[i].facet);
    const auto shape = points_.multiplier_shape(points[i]);
    for (std::size_t a = 0; has_multipliers() && a < shape.size(); ++a)
      square += shape[a] * std::pow(multipliers_[position_[nodes[a]]], 2);
    energy += points[i].weight * contact_potential(augmented_[i], square, points[i].epsilon);
  }
  if (tangential_) energy += tangential_->stored_energy();
  return energy;
}

double ContactForm::work_of_displacement(const State& state) {
  evaluate(state);
  double work = 0.0;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!active_[i]) continue;
    const auto jump = points_.displacement_jump(points[i], state);
    for (int c = 0; c < 3; ++c)
      work += points[i].weight * sigma(i) * points[i].normal[c] * jump[c];
  }
  if (tangential_) work += tangential_->sums().work;
  if (points_.is_following()) work += work_of_turning(state);
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  return work;
}

// --- reports
// -------------------------------------------------------------------------------------------------------------

/// Multipliers where there are some; for penalty the lumped projection of σ onto the multiplier basis. Collective.
std::vector<double> ContactForm::nodal_pressure() {
  std::vector<double> pressure(nodes_.nodes.size());
  if (has_multipliers()) {
    for (std::size_t i = 0; i < pressure.size(); ++i)
      pressure[i] = -multipliers_[i];
    return pressure;
  }
  std::vector<std::vector<double>> load(1, std::vector<double>(pressure.size(), 0.0)), mass = load;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto nodes = points_.slave().facet(points[i].facet);
    const auto shape = points_.multiplier_shape(points[i]);
    for (std::size_t a = 0; a < shape.size(); ++a) {
      load[0][position_[nodes[a]]] -= points[i].weight * shape[a] * sigma(i);
      mass[0][position_[nodes[a]]] += points[i].weight * shape[a];
    }
  }
  for (auto* part : {&load, &mass}) { // sums over the ranks that share a node
    const auto global = space_.new_vector();
    space_.add(*part, global);
    space_.gather(global, *part);
  }
  for (std::size_t i = 0; i < pressure.size(); ++i)
    pressure[i] = load[0][i] / mass[0][i];
  return pressure;
}

ContactSamples ContactForm::samples(const State& state) {
  evaluate(state);
  ContactSamples samples;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& point = points[i];
    samples.facet.push_back(point.facet);
    samples.xi.push_back(points_.xi(point));
    samples.place.push_back(point.place);
    samples.normal.push_back(point.normal);
    if (points_.is_following()) samples.acts_at.push_back(points_.force_place(i));
    samples.weight.push_back(point.weight);
    samples.facet_size.push_back(point.size);
    samples.pressure.push_back(sigma(i) < 0.0 ? -sigma(i) : 0.0);
    samples.gap.push_back(gap_[i]);
    samples.status.push_back(active_[i] ? ContactStatus::Slip : ContactStatus::Open);
  }
  if (tangential_) tangential_->sample(samples);
  samples.nodes = nodes_.nodes;
  samples.nodal_pressure = nodal_pressure();
  return samples;
}

ContactTotals ContactForm::totals(const State& state) {
  evaluate(state);
  ContactTotals totals;
  // Force, moment, area; with friction: tangential force, stick, slip area, dissipation, mismatch, open area, change.
  // Last: turning work.
  double sums[17] = {};
  double largest[2] = {};
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!active_[i]) continue;
    const auto& point = points[i];
    double force[3];
    for (int c = 0; c < 3; ++c)
      force[c] = -sigma(i) * point.weight * point.normal[c];
    for (int c = 0; tangential_ && c < 3; ++c) {
      sums[7 + c] -= tangential_->traction(i)[c] * point.weight;
      force[c] -= tangential_->traction(i)[c] * point.weight;
    }
    for (int c = 0; c < 3; ++c)
      sums[c] += force[c];
    const auto place = points_.force_place(i);
    for (int c = 0; c < 3; ++c)
      sums[3 + c] += place[(c + 1) % 3] * force[(c + 2) % 3] - place[(c + 2) % 3] * force[(c + 1) % 3];
    sums[6] += point.weight;
    largest[1] = std::max(largest[1], -gap_[i] / point.size);
  }
  for (const double pressure : nodal_pressure())
    largest[0] = std::max(largest[0], pressure);
  if (tangential_) {
    const auto friction = tangential_->sums();
    sums[10] = friction.stick_area;
    sums[11] = friction.slip_area;
    sums[12] = friction.dissipation;
    sums[13] = friction.mismatch;
    sums[15] = friction.change;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!active_[i]) sums[14] += points[i].weight;
  }
  sums[16] = turning_work(state);
  MPI_Allreduce(MPI_IN_PLACE, sums, 17, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, layout_.mesh().comm);
  for (int c = 0; c < 3; ++c) {
    totals.force[c] = sums[c];
    totals.moment[c] = sums[3 + c];
    totals.tangential_force[c] = sums[7 + c];
  }
  totals.area = sums[6];
  totals.stick_area = sums[10];
  totals.slip_area = sums[11];
  totals.open_area = sums[14];
  totals.dissipation = sums[12];
  totals.path_error = std::abs(sums[13]) + sums[15];
  totals.turning = sums[16];
  totals.max_pressure = largest[0];
  totals.largest_penetration = largest[1];
  return totals;
}

} // namespace amontons
