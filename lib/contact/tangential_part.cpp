// Small kinematics: projections are fixed in the reference configuration, so a point slides over a fixed place of the
// master and the increment of tangential motion since the last accepted state is
//   Δg_t = P Δ(u_slave − u_master − rigid shift),  P = 1 − n ⊗ n,
// convective and frame-indifferent to first order as the whole of small kinematics is. The shear traction follows from
//   q = P (σ_t,old + Δλ_t) + ε Δg_t,  σ_t = return_map(q, p = −σ_n),  virtual work ∫ σ_t · δg_t,
// with the ε of the normal part, the traction σ_t,old of the point at the last accepted state, and Δλ_t the increment
// of Σ N_i λ_i since then: of nodal vectors held (Uzawa) or unknown (semismooth); zero for penalty.
//
// Why increments of λ_t and not λ_t itself: λ_i is an average over the facets around node i, so λ_t differs from the
// σ_t that it averages by about h² λ_t'' / 6. With q = P λ_t + ε Δg_t a point that sticks needs ε Δg_t = σ_t − λ_t to
// carry its traction, in every increment anew, also where nothing changes: surfaces that stick would creep, the farther
// the more increments are taken. With q as above Δλ_t = 0 and Δg_t = 0 solve an increment without load, and the
// differences add up to h² λ_t'' / (6 ε), as those of the gap do. Both agree in the first increment, and summed over
// increments the nodal equation below is the same. A point that was open has q = P λ_t + ε Δg_t.
//
// Nodal λ_i have dim Cartesian components: no tangent basis has to be chosen at nodes, where the surface has no normal,
// or agreed upon between ranks. As for the normal part they are the lumped projection of the traction,
//   λ_i ∫ N_i = ∫ N_i σ_t,
// which determines all components: that along n is zero on a flat surface and of the order of the facets' angle on a
// curved one, where P removes it at the points. Unknown λ = s μ are scaled like the normal ones; residual rows are
//   δu:  ∫ σ_t · δg_t,    δμ_i:  s ∫ N_i (σ_t − λ_i) / ε.
// With dσ_t = D P (ε dg + s Σ N_i dμ_i) + c dp,  D = ∂σ_t/∂q, c = ∂σ_t/∂p, and dp = −(ε n · dg + s Σ N_i dμ^n_i), the
// tangent is V^T dσ_t − s² δ_ij N_i / ε with V = δg + (s/ε) Σ N_i δμ_i: symmetric in stick, where D = 1 and c = 0, and
// unsymmetric in slip.
//
// The first tangent of an increment takes all points in contact for sticking (the residual is the true one): at the
// last accepted state those that slid stand on the border, a first contact has no pressure and hence no friction yet,
// and a tangent without friction there would send the first iterate far off.
//
// Finite kinematics (dense block: finite_contact.cpp). Δg_t = P (x − ρ(ξ_old)), all in the current configuration: the
// current place of the projection less the current place of the old one, for x − ρ(ξ) lies along n. What a point
// carries over, σ_t,old − λ_t,old, turns with the slave's surface element, q = P (R (σ_t,old − λ_t,old) + λ_t) + ε
// Δg_t, so that a rigid rotation of everything turns tractions and does nothing else.
//
// A point that was open at the last accepted state starts anew: traction zero, law in its initial state. Its Δg_t is
// that of the whole increment, for when in the increment it closed is not known.
#include "contact/tangential_part.hpp"

#include "base/error.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Stands for no status in what the last tangent was made for.
constexpr std::uint8_t unknown_status = 255;

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// v − n (n · v).
TangentVector tangential(const std::array<double, 3>& v, const std::array<double, 3>& n) {
  const double along = dot(v, n);
  return {v[0] - along * n[0], v[1] - along * n[1], v[2] - along * n[2]};
}

} // namespace

TangentialPart::TangentialPart(const DofLayout& layout, const ContactPair& pair, const ContactPoints& points,
                               const NodeField& nodes, std::span<const std::int32_t> position, double scale)
    : layout_(layout), pair_(pair), points_(points), nodes_(nodes), position_(position), scale_(scale),
      multipliers_(layout.dim(), std::vector<double>(nodes.nodes.size(), 0.0)), multipliers_old_(multipliers_) {
  const std::size_t n = points.points().size();
  history_.resize(n);
  if (points.has_rigid_master())
    for (auto& point : history_)
      for (int c = 0; c < 3; ++c)
        point.jump[c] = -points.rigid_shift()[c];
  if (points.is_following()) path_ = std::make_unique<SlipPath>(points);
  factor_.assign(n, 1.0);
  contexts_.resize(n);
  responses_.resize(n);
  jump_.resize(n);
  motion_.resize(n);
  pressure_.assign(n, 0.0);
  active_.assign(n, 0);
  pressed_.assign(n, 0);
  assembled_status_.assign(n, unknown_status);
  if (!is_unknown()) return;
  std::vector<PetscInt> equations;
  for (int c = 0; c < layout.dim(); ++c)
    for (const auto node : nodes.nodes)
      equations.push_back(layout.extra_equation(pair.friction->field + c, node));
  const auto size = static_cast<PetscInt>(equations.size());
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(layout.mesh().comm, size, equations.data(), PETSC_COPY_VALUES, from.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, local_multipliers_.put()));
  const auto global = layout.new_vector();
  AMT_PETSC(VecScatterCreate(global, from, local_multipliers_, nullptr, multiplier_scatter_.put()));
}

// --- state at a point ------------------------------------------------------------------------------------------------

TangentVector TangentialPart::kept(std::size_t i) const {
  const auto& point = points_.points()[i];
  const auto& old = history_[i];
  if (old.open) return {};
  const auto nodes = points_.slave().facet(point.facet);
  const auto shape = points_.multiplier_shape(point);
  TangentVector kept = old.traction;
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < layout_.dim(); ++c)
      kept[c] -= shape[a] * multipliers_old_[c][position_[nodes[a]]];
  if (!path_) return kept;
  TangentVector turned{};
  Eigen::Vector3d::Map(turned.data()) = path_->rotation(i).rotation * Eigen::Vector3d::Map(kept.data());
  return turned;
}

TangentVector TangentialPart::carried(std::size_t i) const {
  const auto& point = points_.points()[i];
  const auto nodes = points_.slave().facet(point.facet);
  const auto shape = points_.multiplier_shape(point);
  TangentVector carried = kept(i);
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < layout_.dim(); ++c)
      carried[c] += shape[a] * multipliers_[c][position_[nodes[a]]];
  return carried;
}

void TangentialPart::fetch_multipliers(const State& state) {
  if (!is_unknown()) return;
  AMT_PETSC(VecScatterBegin(multiplier_scatter_, state.unknowns, local_multipliers_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(multiplier_scatter_, state.unknowns, local_multipliers_, INSERT_VALUES, SCATTER_FORWARD));
  VecReader values(local_multipliers_);
  PetscInt at = 0;
  for (std::size_t c = 0; c < multipliers_.size(); ++c)
    for (std::size_t i = 0; i < multipliers_[c].size(); ++i) {
      const double unknown = scale_ * values[at++];
      if (away_)
        (*away_)[c][i] = unknown - multipliers_[c][i];
      else
        multipliers_[c][i] = unknown;
    }
}

void TangentialPart::hold_multipliers(std::vector<std::vector<double>> multipliers) {
  multipliers_ = std::move(multipliers);
  if (is_sought()) away_.emplace(multipliers_.size(), std::vector<double>(nodes_.nodes.size(), 0.0));
}

double TangentialPart::multiplier_defect_at(std::size_t i, int component, std::int32_t node) const {
  return away_ ? -(*away_)[component][node] : responses_[i].traction[component] - multipliers_[component][node];
}

/// The friction factor of each point, anew when time has changed. Collective.
void TangentialPart::find_factors(double time) {
  if (!pair_.friction->factor || time == factor_time_) return;
  factor_time_ = time;
  together(layout_.mesh().comm, [&] {
    for (std::size_t i = 0; i < factor_.size(); ++i) {
      factor_[i] = (*pair_.friction->factor)(time, points_.points()[i].place);
      if (!(factor_[i] >= 0.0))
        throw UserError("contact: friction_factor of the pair '" + pair_.name +
                        "' is negative or not a number at t = " + std::to_string(time) +
                        ". Make it an expression that is never below zero.");
    }
  });
}

void TangentialPart::evaluate(const State& state, std::span<const double> sigma, std::span<const std::uint8_t> active) {
  fetch_multipliers(state);
  find_factors(state.time);
  const auto& points = points_.points();
  const std::array<double, 3> shift = points_.has_rigid_master() ? points_.rigid_shift() : std::array<double, 3>{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& point = points[i];
    const auto& old = history_[i];
    active_[i] = active[i];
    contexts_[i] = {.dt = std::max(0.0, state.time - accepted_time_), .factor = factor_[i], .new_contact = old.open};
    jump_[i] = points_.displacement_jump(point, state);
    std::array<double, 3> trial{};
    for (int c = 0; c < 3; ++c) {
      jump_[i][c] -= shift[c];
      motion_[i][c] = jump_[i][c] - old.jump[c];
    }
    pressure_[i] = held_pressure_.empty() ? std::max(0.0, -sigma[i]) : held_pressure_[i];
    if (!active[i]) {
      responses_[i] = {};
      pressed_[i] = 0;
      continue;
    }
    if (path_) Eigen::Vector3d::Map(motion_[i].data()) = path_->moved(i);
    const auto held = tangential(carried(i), point.normal);
    const auto increment = tangential(motion_[i], point.normal);
    if (path_) motion_[i] = increment;
    for (int c = 0; c < 3; ++c)
      trial[c] = held[c] + point.epsilon * increment[c];
    pressed_[i] = held_pressure_.empty() && sigma[i] < 0.0;
    responses_[i] = return_map(pair_.friction->law, contexts_[i], trial, pressure_[i], point.epsilon, old.state);
  }
}

ContactStatus TangentialPart::status(std::size_t i) const {
  if (!active_[i]) return ContactStatus::Open;
  return responses_[i].status == FrictionStatus::Slip ? ContactStatus::Slip : ContactStatus::Stick;
}

FrictionResponse TangentialPart::guess(std::size_t i) const {
  return guess_response(pair_.friction->law, contexts_[i], responses_[i].traction, pressure_[i],
                        points_.points()[i].epsilon, history_[i].state, history_[i].slip_rate * contexts_[i].dt);
}

// --- assembly --------------------------------------------------------------------------------------------------------

void TangentialPart::gather_multiplier_equations(std::int32_t facet, std::vector<PetscInt>& equations) const {
  if (!is_unknown()) return;
  const auto nodes = points_.slave().facet(facet);
  for (int a = 0; a < num_vertices(points_.slave().types[facet]); ++a)
    for (int c = 0; c < layout_.dim(); ++c)
      equations.push_back(layout_.extra_equation(pair_.friction->field + c, nodes[a]));
}

void TangentialPart::add_residual(std::size_t begin, std::size_t end, Residual& residual) const {
  const auto& points = points_.points();
  const auto& first = points[begin];
  const int d = layout_.dim();
  const auto nodes = points_.slave().facet(first.facet);
  std::vector<PetscInt> masters, unknowns;
  if (first.master >= 0)
    for (const auto node : points_.master()->stencil(first.master)) {
      const auto of_node = points_.master()->equations(node);
      masters.insert(masters.end(), of_node.begin(), of_node.end());
    }
  gather_multiplier_equations(first.facet, unknowns);
  std::vector<double> on_master(masters.size(), 0.0), on_unknowns(unknowns.size(), 0.0);
  bool any = false;
  for (std::size_t i = begin; i < end; ++i) {
    const auto& traction = responses_[i].traction;
    const double weight = points[i].weight;
    if (active_[i]) {
      any = true;
      const auto shape = points_.slave_shape(points[i]);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int c = 0; c < d; ++c)
          residual.nodal()[std::size_t(nodes[a]) * d + c] += weight * shape[a] * traction[c];
      for (std::size_t k = 0; k < masters.size(); ++k)
        on_master[k] -= weight * points[i].master_shape[k / d] * traction[k % d];
    }
    if (!is_unknown()) continue;
    const auto shape = points_.multiplier_shape(points[i]);
    const double factor = weight * scale_ / points[i].epsilon;
    for (std::size_t a = 0; a < shape.size(); ++a)
      for (int c = 0; c < d; ++c)
        on_unknowns[a * d + c] += factor * shape[a] * multiplier_defect_at(i, c, position_[nodes[a]]);
  }
  if (any) residual.add(masters, on_master);
  if (is_unknown()) residual.add(unknowns, on_unknowns);
}

bool TangentialPart::add_tangent(std::size_t begin, std::size_t end, const ContactBlock& layout, bool first_guess,
                                 std::span<double> block) const {
  const auto& points = points_.points();
  const int d = layout_.dim();
  const std::size_t n = layout.size;
  std::vector<double> motion(d * n), response(d * n), test(d * n); // rows: components; columns: equations
  bool any = false;
  for (std::size_t i = begin; i < end; ++i) {
    const auto& point = points[i];
    const auto shape = points_.multiplier_shape(point);
    const double weight = point.weight;
    if (is_unknown()) {
      any = true;
      for (std::size_t a = 0; a < shape.size(); ++a)
        for (int c = 0; c < d; ++c)
          block[(layout.tangential_multipliers + a * d + c) * (n + 1)] -=
              weight * scale_ * scale_ / point.epsilon * shape[a];
    }
    if (!active_[i]) continue;
    any = true;
    jump_variation(point, layout, motion);
    trial_tangent(i, layout, first_guess, motion, response);
    test = motion;
    if (is_sought())
      for (std::size_t a = 0; a < shape.size(); ++a)
        for (int c = 0; c < d; ++c)
          test[c * n + layout.tangential_multipliers + a * d + c] = scale_ / point.epsilon * shape[a];
    for (int c = 0; c < d; ++c)
      for (std::size_t row = 0; row < n; ++row) {
        const double factor = weight * test[c * n + row];
        if (factor == 0.0) continue;
        for (std::size_t column = 0; column < n; ++column)
          block[row * n + column] += factor * response[c * n + column];
      }
  }
  return any;
}

/// ∂(u_slave − u_master) / ∂(equations), dim x n.
void TangentialPart::jump_variation(const ContactPoint& point, const ContactBlock& layout,
                                    std::span<double> motion) const {
  const int d = layout_.dim();
  const std::size_t n = layout.size;
  std::fill(motion.begin(), motion.end(), 0.0);
  const auto shape = points_.slave_shape(point);
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < d; ++c)
      motion[c * n + a * d + c] = shape[a];
  if (layout.master < 0) return;
  for (std::size_t b = 0; b < points_.master()->stencil(point.master).size(); ++b)
    for (int c = 0; c < d; ++c)
      motion[c * n + layout.master + b * d + c] = -point.master_shape[b];
}

/// ∂σ_t / ∂(equations), dim x n.
void TangentialPart::trial_tangent(std::size_t i, const ContactBlock& layout, bool first_guess,
                                   std::span<const double> motion, std::span<double> response) const {
  const auto& point = points_.points()[i];
  const auto derivative = first_guess ? guess(i) : responses_[i];
  const int d = layout_.dim();
  const std::size_t n = layout.size;
  std::array<std::array<double, 3>, 3> projected{}; // D P
  for (int r = 0; r < d; ++r)
    projected[r] = tangential(derivative.dtraction_dq[r], point.normal);
  const auto shape = points_.multiplier_shape(point);
  for (std::size_t column = 0; column < n; ++column) {
    double along = 0.0;
    for (int c = 0; c < d; ++c)
      along += point.normal[c] * motion[c * n + column];
    for (int r = 0; r < d; ++r) {
      double sum = pressed_[i] ? -derivative.dtraction_dp[r] * along : 0.0;
      for (int c = 0; c < d; ++c)
        sum += projected[r][c] * motion[c * n + column];
      response[r * n + column] = point.epsilon * sum;
    }
  }
  if (!is_sought()) return;
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int r = 0; r < d; ++r) {
      if (pressed_[i])
        response[r * n + layout.normal_multipliers + a] -= scale_ * shape[a] * derivative.dtraction_dp[r];
      for (int c = 0; c < d; ++c)
        response[r * n + layout.tangential_multipliers + a * d + c] += scale_ * shape[a] * projected[r][c];
    }
}

bool TangentialPart::tangent_changed() const {
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    const auto now = status(i);
    if (now == ContactStatus::Slip || static_cast<std::uint8_t>(now) != assembled_status_[i]) return true;
  }
  return false;
}

void TangentialPart::remember_tangent(bool first_guess) {
  for (std::size_t i = 0; i < responses_.size(); ++i)
    assembled_status_[i] = first_guess ? unknown_status : static_cast<std::uint8_t>(status(i));
}

void TangentialPart::hold_pressure() { held_pressure_ = pressure_; }

// --- history and multipliers -----------------------------------------------------------------------------------------

void TangentialPart::commit(const State& state) {
  for (std::size_t i = 0; i < history_.size(); ++i)
    history_[i] = {.traction = responses_[i].traction,
                   .jump = jump_[i],
                   .state = responses_[i].state,
                   .slip = history_[i].slip + responses_[i].slip,
                   .slip_rate = contexts_[i].dt > 0.0 ? responses_[i].slip / contexts_[i].dt : 0.0,
                   .open = active_[i] == 0};
  multipliers_old_ = multipliers_;
  accepted_time_ = state.time;
}

void TangentialPart::remember() {
  if (path_) path_->accept();
}

void TangentialPart::roll_back() {
  multipliers_ = multipliers_old_;
  forget_course(); // going on like that has failed
}

void TangentialPart::forget_course() {
  for (auto& point : history_)
    point.slip_rate = 0.0;
}

void TangentialPart::save(ContactHistory& history) const {
  history.time = accepted_time_;
  history.tangential_multipliers = multipliers_old_;
  history.points = history_;
  if (path_) history.places = path_->places();
}

void TangentialPart::restore(const ContactHistory& history) {
  accepted_time_ = history.time;
  multipliers_ = multipliers_old_ = history.tangential_multipliers;
  history_ = history.points;
  if (path_) path_->restore(history.places);
}

std::vector<std::vector<double>> TangentialPart::multiplier_defect() const {
  std::vector<std::vector<double>> defect(multipliers_.size(), std::vector<double>(nodes_.nodes.size(), 0.0));
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto nodes = points_.slave().facet(points[i].facet);
    const auto shape = points_.multiplier_shape(points[i]);
    const double weight = points[i].weight / points[i].epsilon;
    for (std::size_t a = 0; a < shape.size(); ++a)
      for (std::size_t c = 0; c < defect.size(); ++c) {
        const auto at = position_[nodes[a]];
        defect[c][at] += weight * shape[a] * (responses_[i].traction[c] - multipliers_[c][at]);
      }
  }
  return defect;
}

// --- energy and reports ----------------------------------------------------------------------------------------------

/// Potential of a point, lumped as the multipliers are: (|σ_t|² − Σ N_i |λ_i|²) / (2 ε). With σ_t − P λ_t = ε g_e,
///   dψ = σ_t · dg_e + Σ N_i (σ_t − λ_i) · dλ_i / ε,
/// the last part of which is zero in the sum over the surface: what sticking points move is elastic.
double TangentialPart::spring_energy(std::size_t i, const TangentVector& traction,
                                     const std::vector<std::vector<double>>& multipliers) const {
  const auto& point = points_.points()[i];
  double square = dot(traction, traction);
  if (has_multipliers()) {
    const auto nodes = points_.slave().facet(point.facet);
    const auto shape = points_.multiplier_shape(point);
    for (std::size_t a = 0; a < shape.size(); ++a)
      for (const auto& component : multipliers)
        square -= shape[a] * std::pow(component[position_[nodes[a]]], 2);
  }
  return square / (2.0 * point.epsilon);
}

double TangentialPart::stored_energy() const {
  double energy = 0.0;
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i)
    energy += points[i].weight * spring_energy(i, responses_[i].traction, multipliers_);
  return energy;
}

TangentialSums TangentialPart::sums() const {
  TangentialSums sums;
  const auto& points = points_.points();
  const auto shift = points_.has_rigid_master() ? points_.rigid_shift() : std::array<double, 3>{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& now = responses_[i];
    const auto& old = history_[i];
    const double weight = points[i].weight;
    if (status(i) == ContactStatus::Stick) sums.stick_area += weight;
    if (status(i) == ContactStatus::Slip) sums.slip_area += weight;
    const double dissipation = dot(now.traction, slip_vector(now));
    sums.dissipation += weight * dissipation;
    for (int c = 0; c < 3; ++c)
      sums.work += weight * now.traction[c] * (jump_[i][c] + shift[c]);
    const double at_end = dot(now.traction, motion_[i]), at_start = dot(old.traction, motion_[i]);
    const double stored =
        spring_energy(i, now.traction, multipliers_) - spring_energy(i, old.traction, multipliers_old_);
    sums.mismatch += weight * (0.5 * (at_end + at_start) - dissipation - stored);
    sums.change += weight * 0.5 * std::abs(at_end - at_start);
  }
  return sums;
}

void TangentialPart::sample(ContactSamples& samples) const {
  samples.has_friction = true;
  const auto names = state_names(pair_.friction->law);
  samples.state_names.assign(names.begin(), names.end());
  samples.states.assign(names.size(), {});
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    samples.status[i] = status(i);
    const auto& traction = responses_[i].traction; // conjugate to u_slave: what the slave exerts
    samples.shear.push_back({-traction[0], -traction[1], -traction[2]});
    samples.tau_c.push_back(responses_[i].tau_c);
    samples.slip.push_back(slip_vector(responses_[i]));
    samples.accumulated_slip.push_back(history_[i].slip + responses_[i].slip);
    samples.friction_context.push_back(contexts_[i]);
    samples.friction_state_old.push_back(history_[i].state);
    for (std::size_t k = 0; k < samples.states.size(); ++k)
      samples.states[k].push_back(responses_[i].state[k]);
  }
}

} // namespace amontons
