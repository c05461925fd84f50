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

void ContactForm::scale_augmentation(double factor) {
  points_.scale_augmentation(factor);
  assembled_ = false;
}

} // namespace amontons
