// The part of ContactForm for rigid masters whose normal at a point turns as they move.
#include "contact/contact_form.hpp"

namespace amontons {

/// Has the pair a rigid master whose normal at a point of the reference configuration changes as it moves?
bool ContactForm::master_turns() const {
  if (points_.is_following()) return false;
  const auto* rigid = std::get_if<RigidMaster>(&pair_.master);
  return rigid && !std::holds_alternative<RigidPlane>(rigid->shape);
}

std::array<double, 3> ContactForm::relative_jump(const ContactPoint& point, const State& state) const {
  auto jump = points_.displacement_jump(point, state);
  for (int c = 0; c < 3; ++c)
    jump[c] -= points_.rigid_shift()[c];
  return jump;
}

void ContactForm::remember(const State& state) {
  if (!master_turns() && !points_.is_following()) return;
  evaluate(state);
  if (points_.is_following()) {
    points_.accept();
    if (tangential_) tangential_->remember();
    return;
  }
  const auto& points = points_.points();
  for (std::size_t i = 0; i < points.size(); ++i)
    normals_old_[i] = {
        .sigma = sigma(i), .gap = gap_[i], .normal = points[i].normal, .jump = relative_jump(points[i], state)};
}

/// Σ ½ (σ_old n_old + σ n) · Δjump − ½ (σ_old + σ) Δg over this rank's points: work of the normal traction that goes
/// into no potential. Small kinematics takes a curved rigid master's normal at the slave's reference place, so that
/// g = g0 + n · u changes by Δn · u, too, as the master moves on.
double ContactForm::turning_work(const State& state) const {
  double work = 0.0;
  for (std::size_t i = 0; i < normals_old_.size(); ++i) {
    const auto& point = points_.points()[i];
    const auto& old = normals_old_[i];
    const auto jump = relative_jump(point, state);
    double power = -(old.sigma + sigma(i)) * (gap_[i] - old.gap);
    for (int c = 0; c < 3; ++c)
      power += (old.sigma * old.normal[c] + sigma(i) * point.normal[c]) * (jump[c] - old.jump[c]);
    work += 0.5 * point.weight * power;
  }
  return work;
}

} // namespace amontons
