// With u = T û (mortar_transform.cpp) slave node k moves against its master by û along axes of its own: the normal
// ñ/|ñ| in place of component h, tangents t_c in place of its other free components. What these unknowns are out of
// balance by without contact, f = Tᵀ r, are the nodal forces of contact alone, because the dual basis makes D diagonal:
//   f_h + D ℓ λ_n = 0,   f_c + D t_c · λ_t = 0,   ℓ = |ñ|, D = ∫ ψ_k.
// So λ_n = −f_h / (D ℓ) and λ_t = −Σ t_c f_c / D, row by row: no multiplier is an unknown. Put into the conditions of
// the augmented Lagrangian (kernel.hpp, tangential_part.cpp),
//   λ̂_n = λ_n + ε g,  g = κ ℓ (û_h − bound),  σ_n = min(0, λ̂_n);   q = λ_t + ε Δg_t,  σ_t = return_map(q, p = −σ_n),
// with Δg_t = κ Σ t_c Δû_c and κ = D / ∫ ψ (1 but where neighbours are left out, mortar_form.cpp), they make the
// residual of the transformed problem
//   R_h = f_h + D ℓ σ_n   (open: f_h; closed: D ε ℓ g),
//   R_c = f_c + D t_c · σ_t   (stick: D ε t_c · Δg_t),
// displacement-only, with the primal-dual active set as its semismooth Newton method (S. Hüeber, B. I. Wohlmuth,
// Comput. Methods Appl. Mech. Engrg. 194 (2005) 3147-3166; friction: S. Hüeber, G. Stadler, B. I. Wohlmuth, SIAM J.
// Sci. Comput. 30 (2008) 572-596; M. Gitterle, A. Popp, M. Gee, W. Wall, Int. J. Numer. Meth. Engng. 84 (2010)
// 543-571). At the solution ε has dropped out. Its derivative, closed, with D_q = ∂σ_t/∂q, c_p = ∂σ_t/∂p:
//   dR_h = D ε κ ℓ² dû_h
//   dR_c = df_c − Σ_e (t_c · D_q t_e) (df_e − D ε κ dû_e) + t_c · c_p (df_h / ℓ − D ε κ ℓ dû_h)
// where df is the row of Tᵀ K T; without friction it stays symmetric, for a fixed û_h takes its column along.
//
// The first step of an increment takes closed nodes for sticking, in residual and derivative: at the last accepted
// state those that slid stand on the border, and a first contact has no pressure and hence no friction yet.
#include "contact/condensed_contact.hpp"

#include "contact/kernel.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void add(std::array<double, 3>& sum, double factor, const std::array<double, 3>& vector) {
  for (std::size_t c = 0; c < 3; ++c)
    sum[c] += factor * vector[c];
}

} // namespace

class CondensedContact::PairNodes : public Switching {
 public:
  PairNodes(CondensedContact& contact, std::size_t pair) : contact_(contact), pair_(pair) {
    const auto& form = *contact.transform_.pairs()[pair];
    const auto& mesh = contact.problem_.layout().mesh();
    point_of_.assign(form.nodes().nodes.size(), none);
    for (std::size_t place = 0; place < point_of_.size(); ++place)
      if (form.nodes().nodes[place] < mesh.num_owned) {
        point_of_[place] = places_.size();
        places_.push_back(place);
      }
    held_pressure_.assign(places_.size(), 0.0);
  }

  const std::string& switch_name() const override { return form().pair().name; }
  std::array<double, 3> switch_place(std::size_t point) const override {
    return node_place(contact_.problem_.layout().mesh(), form().nodes().nodes[places_[point]]);
  }
  std::vector<std::uint8_t> branches() const override {
    return of_nodes([this](const Node& node) {
      if (!node.closed) return ContactStatus::Open;
      const bool slips = !form().friction() || node.response.status == FrictionStatus::Slip;
      return slips ? ContactStatus::Slip : ContactStatus::Stick;
    });
  }
  void hold(std::vector<Hold> holds) override { holds_ = std::move(holds); }
  std::vector<std::uint8_t> wanted() const override {
    return of_nodes([](const Node& node) { return node.wanted; });
  }
  bool has_limits() const override { return form().friction() != nullptr; }
  void hold_limits() override {
    limits_are_held_ = true;
    for (const auto& node : contact_.nodes_)
      if (node.pair == pair_)
        held_pressure_[point_of_[node.place]] = node.closed ? -normal_traction(node.augmented) : 0.0;
  }
  void release_limits() override { limits_are_held_ = false; }
  void scale_augmentation(double factor) override { augmentation_ = factor; }

  Hold hold(const Node& node) const { return holds_.empty() ? Hold::Free : holds_[point_of_[node.place]]; }
  double augmentation() const { return augmentation_; }
  bool limits_are_held() const { return limits_are_held_; }
  /// Pressure that bounds friction.
  double bounding_pressure(const Node& node) const {
    return limits_are_held_ ? held_pressure_[point_of_[node.place]] : -normal_traction(node.augmented);
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  const MortarForm& form() const { return *contact_.transform_.pairs()[pair_]; }
  template <class Value>
  std::vector<std::uint8_t> of_nodes(Value&& value) const {
    std::vector<std::uint8_t> values(places_.size(), std::uint8_t(0));
    for (const auto& node : contact_.nodes_)
      if (node.pair == pair_) values[point_of_[node.place]] = static_cast<std::uint8_t>(value(node));
    return values;
  }

  CondensedContact& contact_;
  std::size_t pair_;
  std::vector<std::size_t> places_, point_of_; // of points (nodes of this rank) in nodes() of the pair, and back
  std::vector<Hold> holds_;
  std::vector<double> held_pressure_; // per point
  bool limits_are_held_ = false;
  double augmentation_ = 1.0;
};

CondensedContact::~CondensedContact() = default;

CondensedContact::CondensedContact(const Problem& problem, const std::vector<MortarForm*>& pairs)
    : problem_(problem), transform_(problem, pairs) {
  collect_nodes();
  for (std::size_t p = 0; p < pairs.size(); ++p)
    switching_.push_back(std::make_unique<PairNodes>(*this, p));
}

std::vector<Switching*> CondensedContact::switching() {
  std::vector<Switching*> all;
  for (const auto& nodes : switching_)
    all.push_back(nodes.get());
  return all;
}

double CondensedContact::epsilon(const Node& node) const {
  return switching_[node.pair]->augmentation() * constraint(node).epsilon;
}

/// A node held closed stays where it touches even if that takes tension; its friction then has no limit to bear on.
void CondensedContact::apply_holds() {
  for (auto& node : nodes_) {
    node.wanted = node.closed;
    const auto hold = switching_[node.pair]->hold(node);
    if (hold != Switching::Hold::Free) node.closed = hold == Switching::Hold::On;
  }
}

void CondensedContact::collect_nodes() {
  const auto& mesh = problem_.layout().mesh();
  nodes_.clear();
  for (std::size_t p = 0; p < transform_.pairs().size(); ++p)
    for (std::size_t i = 0; i < transform_.frames(p).size(); ++i) {
      const auto node = transform_.pairs()[p]->nodes().nodes[i];
      if (transform_.frames(p)[i].bounded && node < mesh.num_owned)
        nodes_.push_back({.pair = p, .place = i, .first = node * mesh.dim});
    }
}

bool CondensedContact::update(double time) {
  time_ = time;
  for (auto* pair : transform_.pairs())
    if (pair->friction()) pair->friction()->move_to(time);
  const bool moved = transform_.update(time);
  if (moved) collect_nodes();
  return moved;
}

void CondensedContact::evaluate(Vec changed, Vec forces, Evaluation evaluation, Vec residual) {
  {
    const VecReader motions(changed), out_of_balance(forces);
    find_normal_part(motions, out_of_balance);
    if (evaluation == Evaluation::FirstGuess) guess_contact();
    apply_holds();
    for (auto& node : nodes_)
      if (pair(node).friction()) find_tangential_part(node, motions, out_of_balance, evaluation);
  }
  rows_.clear();
  for (const auto& node : nodes_) {
    if (!node.closed) continue;
    set_residual(node, residual);
    rows_.push_back(rows_of(node));
  }
}

void CondensedContact::find_normal_part(const VecReader& changed, const VecReader& forces) {
  const VecReader lower(transform_.lower());
  for (auto& node : nodes_) {
    const auto& frame = this->frame(node);
    const auto& constraint = this->constraint(node);
    const PetscInt host = node.first + frame.host;
    node.motion = changed[host] - lower[host];
    const double lambda = -forces[host] / (constraint.weight * frame.length);
    node.augmented = augmented_traction(lambda, epsilon(node), gap(node));
    node.closed = normal_traction_derivative(node.augmented) > 0.0;
  }
}

/// As ContactForm: where nothing of a pair touches, the nodes where the surfaces are nearest count as closed when the
/// surfaces (nearly) touch or a body has nothing else to hold it.
void CondensedContact::guess_contact() {
  const std::size_t count = transform_.pairs().size();
  std::vector<double> nearest(count, 1e300), touches(count, 0.0); // gap / h
  const auto distance = [&](const Node& node) { return gap(node) / constraint(node).size; };
  for (const auto& node : nodes_) {
    nearest[node.pair] = std::min(nearest[node.pair], distance(node));
    if (node.closed) touches[node.pair] = 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, nearest.data(), static_cast<int>(count), MPI_DOUBLE, MPI_MIN, problem_.comm());
  MPI_Allreduce(MPI_IN_PLACE, touches.data(), static_cast<int>(count), MPI_DOUBLE, MPI_MAX, problem_.comm());
  for (auto& node : nodes_) {
    const bool is_guessed = nearest[node.pair] <= guess_reach || pair(node).pair().holds_floating_body;
    if (touches[node.pair] == 0.0 && is_guessed) node.closed = distance(node) <= nearest[node.pair] + guess_reach;
  }
}

void CondensedContact::find_tangential_part(Node& node, const VecReader& changed, const VecReader& forces,
                                            Evaluation evaluation) const {
  const auto& frame = this->frame(node);
  const auto& constraint = this->constraint(node);
  const auto& friction = *pair(node).friction();
  node.jump = {};
  for (int c = 0; c < problem_.layout().dim(); ++c)
    if (frame.is_free[c]) add(node.jump, constraint.leverage() * changed[node.first + c], frame.axis(c));
  if (pair(node).points().has_rigid_master()) add(node.jump, -1.0, pair(node).rigid_shift());
  node.trial = {};
  if (!node.closed) return;
  const auto motion = friction.motion(node.place, node.jump);
  for (int c = 0; c < problem_.layout().dim(); ++c) {
    if (!frame.is_free[c] || c == frame.host) continue;
    const auto axis = frame.axis(c);
    add(node.trial, -forces[node.first + c] / constraint.weight + epsilon(node) * dot(axis, motion), axis);
  }
  const double pressure = switching_[node.pair]->bounding_pressure(node);
  node.response = evaluation == Evaluation::FirstGuess
                      ? friction.guess(node.place, node.trial, pressure, epsilon(node))
                      : friction.respond(node.place, node.trial, pressure, epsilon(node));
}

void CondensedContact::set_residual(const Node& node, Vec residual) const {
  const auto& frame = this->frame(node);
  const auto& constraint = this->constraint(node);
  VecArray values(residual);
  values[node.first + frame.host] = constraint.weight * epsilon(node) * frame.length * gap(node);
  if (!pair(node).friction()) return;
  for (int c = 0; c < problem_.layout().dim(); ++c)
    if (frame.is_free[c] && c != frame.host)
      values[node.first + c] += constraint.weight * dot(frame.axis(c), node.response.traction);
}

ConditionRows CondensedContact::rows_of(const Node& node) const {
  const auto& frame = this->frame(node);
  const auto& constraint = this->constraint(node);
  const double stiffness = constraint.weight * epsilon(node) * constraint.leverage();
  const int dim = problem_.layout().dim(), h = frame.host;
  ConditionRows rows{.size = dim};
  for (int r = 0; r < dim; ++r) {
    rows.equations[r] = problem_.layout().first_equation() + node.first + r;
    rows.forces[r][r] = 1.0;
  }
  rows.forces[h][h] = 0.0;
  rows.motion[h][h] = stiffness * frame.length * frame.length;
  if (!pair(node).friction()) return rows;
  const auto& derivative = node.response;
  const bool follows_pressure = node.augmented < 0.0 && !switching_[node.pair]->limits_are_held();
  for (int r = 0; r < dim; ++r) {
    if (!frame.is_free[r] || r == h) continue;
    const auto row = frame.axis(r);
    const double by_pressure = follows_pressure ? dot(row, derivative.dtraction_dp) : 0.0;
    rows.forces[r][h] = by_pressure / frame.length;
    rows.motion[r][h] = -by_pressure * stiffness * frame.length;
    for (int c = 0; c < dim; ++c) {
      if (!frame.is_free[c] || c == h) continue;
      const auto column = frame.axis(c);
      double part = 0.0;
      for (int i = 0; i < 3; ++i)
        part += row[i] * dot(derivative.dtraction_dq[i], column);
      rows.forces[r][c] -= part;
      rows.motion[r][c] = stiffness * part;
    }
  }
  return rows;
}

/// Work: f δû_h = λ D ℓ δû_h.
void CondensedContact::hold() {
  const auto forces = problem_.layout().new_vector();
  {
    VecArray values(forces);
    for (const auto& node : nodes_)
      if (node.closed)
        values[node.first + frame(node).host] =
            -normal_traction(node.augmented) * constraint(node).weight * frame(node).length;
  }
  transform_.hold_forces(forces);
  for (std::size_t p = 0; p < transform_.pairs().size(); ++p)
    if (transform_.pairs()[p]->friction()) hold_friction(p);
}

/// Every rank that has a node asks the law for itself, with the same numbers.
void CondensedContact::hold_friction(std::size_t p) {
  auto& form = *transform_.pairs()[p];
  const std::size_t count = form.nodes().nodes.size();
  std::vector<std::vector<double>> fields(6, std::vector<double>(count, 0.0));
  for (const auto& node : nodes_)
    for (std::size_t c = 0; node.pair == p && c < 3; ++c) {
      fields[c][node.place] = node.trial[c];
      fields[3 + c][node.place] = node.jump[c]; // of open nodes too: what they move is not slip of a later increment
    }
  const NodeSpace space(problem_.layout().mesh(), std::vector<NodeField>(6, form.nodes()));
  const auto global = space.new_vector();
  space.add(fields, global);
  space.gather(global, fields);
  NodalFriction::Claim claim;
  for (std::size_t i = 0; i < count; ++i) {
    claim.trial.push_back({fields[0][i], fields[1][i], fields[2][i]});
    claim.jump.push_back({fields[3][i], fields[4][i], fields[5][i]});
  }
  form.hold_friction(claim);
}

} // namespace amontons
