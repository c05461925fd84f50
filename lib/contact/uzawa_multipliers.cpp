#include "contact/uzawa_multipliers.hpp"

namespace amontons {

UzawaMultipliers::UzawaMultipliers(const Mesh& mesh, std::vector<ContactForm*> pairs)
    : pairs_(std::move(pairs)), space_(mesh, fields(pairs_)), counts_(space_.new_vector()) {
  std::vector<std::vector<double>> ones;
  for (const auto* pair : pairs_)
    ones.emplace_back(pair->nodes().nodes.size(), 1.0);
  space_.add(ones, counts_);
}

std::vector<NodeField> UzawaMultipliers::fields(const std::vector<ContactForm*>& pairs) {
  std::vector<NodeField> all;
  for (const auto* pair : pairs)
    all.push_back(pair->nodes());
  return all;
}

void UzawaMultipliers::get(Vec multipliers) const {
  std::vector<std::vector<double>> held;
  for (const auto* pair : pairs_)
    held.push_back(pair->multipliers());
  AMT_PETSC(VecSet(multipliers, 0.0));
  space_.add(held, multipliers);
  AMT_PETSC(VecPointwiseDivide(multipliers, multipliers, counts_));
}

void UzawaMultipliers::set(Vec multipliers) {
  std::vector<std::vector<double>> values;
  space_.gather(multipliers, values);
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    pairs_[i]->hold_multipliers(std::move(values[i]));
}

void UzawaMultipliers::updated(const State& state, Vec multipliers) {
  std::vector<std::vector<double>> defects(pairs_.size()), masses(pairs_.size());
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    pairs_[i]->multiplier_defect(state, defects[i], masses[i]);
  const auto defect = new_vector(), mass = new_vector();
  space_.add(defects, defect);
  space_.add(masses, mass);
  AMT_PETSC(VecPointwiseDivide(defect, defect, mass));
  get(multipliers);
  AMT_PETSC(VecAXPY(multipliers, 1.0, defect));
}

} // namespace amontons
