// What detection and remedies see of a contact pair: the status of its points, and how to hold it.
#include "contact/contact_form.hpp"

namespace amontons {

std::vector<std::uint8_t> ContactForm::branches() const {
  std::vector<std::uint8_t> branches(active_.size());
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const auto status = tangential_ ? tangential_->status(i) : active_[i] ? ContactStatus::Slip : ContactStatus::Open;
    branches[i] = static_cast<std::uint8_t>(status);
  }
  return branches;
}

void ContactForm::hold(std::vector<Hold> holds) { holds_ = std::move(holds); }

/// A point held closed carries λ̂ even where that is tension, one held open carries nothing: the equations are those of
/// the status that is held. Points without a master stay open.
void ContactForm::apply_holds() {
  wanted_ = active_;
  for (std::size_t i = 0; i < active_.size(); ++i)
    if (holds_[i] != Hold::Free && points_.points()[i].master != ContactPoint::none) active_[i] = holds_[i] == Hold::On;
}

void ContactForm::hold_limits() {
  if (tangential_) tangential_->hold_pressure();
}

void ContactForm::release_limits() {
  if (tangential_) tangential_->release_pressure();
}

// Unknown multipliers that are held, for the length of a solve: σ = P(λ + ε g) with the λ held, whatever the unknowns s
// μ are, and in place of s ∫ N_i (σ − λ_i) / ε = 0 the equation s ∫ N_i (λ_i − s μ_i) / ε = 0. Its derivative is the
// diagonal that the true one has for an open point. So the displacements solve what Uzawa's method asks of them, on the
// layout of the true equations, and the unknowns end at the λ held; the tangent keeps its pattern and its symmetry.

void ContactForm::fetch_multipliers(const State& state) {
  if (!is_unknown()) return;
  AMT_PETSC(VecScatterBegin(multiplier_scatter_, state.unknowns, local_multipliers_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(multiplier_scatter_, state.unknowns, local_multipliers_, INSERT_VALUES, SCATTER_FORWARD));
  VecReader values(local_multipliers_);
  for (std::size_t i = 0; i < multipliers_.size(); ++i) {
    const double unknown = scale_ * values[static_cast<PetscInt>(i)];
    if (away_)
      (*away_)[i] = unknown - multipliers_[i];
    else
      multipliers_[i] = unknown;
  }
}

/// What the equation of a multiplier makes zero at a point: traction.
double ContactForm::multiplier_defect_at(std::size_t i, std::int32_t node) const {
  return away_ ? -(*away_)[node] : sigma(i) - multipliers_[node];
}

void ContactForm::hold_multipliers(std::vector<double> multipliers) {
  multipliers_ = std::move(multipliers);
  if (!is_sought()) return;
  away_.emplace(multipliers_.size(), 0.0);
  assembled_ = false;
}

void ContactForm::release_multipliers() {
  if (!away_) return;
  away_.reset();
  if (tangential_) tangential_->release_multipliers();
  assembled_ = false;
}

void ContactForm::scale_augmentation(double factor) {
  points_.scale_augmentation(factor);
  assembled_ = false;
}

} // namespace amontons
