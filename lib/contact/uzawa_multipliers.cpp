#include "contact/uzawa_multipliers.hpp"

namespace amontons {

UzawaMultipliers::UzawaMultipliers(const Mesh& mesh, std::vector<ContactForm*> pairs)
    : pairs_(std::move(pairs)), space_(mesh, fields(pairs_)), counts_(space_.new_vector()) {
  std::vector<std::vector<double>> ones;
  for (const auto& field : space_.fields())
    ones.emplace_back(field.nodes.size(), 1.0);
  space_.add(ones, counts_);
}

std::vector<NodeField> UzawaMultipliers::fields(const std::vector<ContactForm*>& pairs) {
  std::vector<NodeField> all;
  for (const auto* pair : pairs) {
    all.push_back(pair->nodes());
    if (pair->tangential()) all.insert(all.end(), pair->tangential()->multipliers().size(), pair->nodes());
  }
  return all;
}

void UzawaMultipliers::get(Vec multipliers) const {
  std::vector<std::vector<double>> held;
  for (const auto* pair : pairs_) {
    held.push_back(pair->multipliers());
    if (const auto* tangential = pair->tangential())
      held.insert(held.end(), tangential->multipliers().begin(), tangential->multipliers().end());
  }
  AMT_PETSC(VecSet(multipliers, 0.0));
  space_.add(held, multipliers);
  AMT_PETSC(VecPointwiseDivide(multipliers, multipliers, counts_));
}

void UzawaMultipliers::set(Vec multipliers) {
  std::vector<std::vector<double>> values;
  space_.gather(multipliers, values);
  auto next = values.begin();
  for (auto* pair : pairs_) {
    pair->hold_multipliers(std::move(*next++));
    if (auto* tangential = pair->tangential()) {
      const auto end = next + static_cast<std::ptrdiff_t>(tangential->multipliers().size());
      tangential->hold_multipliers({next, end});
      next = end;
    }
  }
}

void UzawaMultipliers::updated(const State& state, Vec multipliers) {
  std::vector<std::vector<double>> defects, masses;
  for (auto* pair : pairs_) {
    std::vector<double> normal, weights;
    pair->multiplier_defect(state, normal, weights);
    defects.push_back(std::move(normal));
    masses.push_back(weights);
    if (!pair->tangential()) continue;
    for (auto& component : pair->tangential()->multiplier_defect()) {
      defects.push_back(std::move(component));
      masses.push_back(weights);
    }
  }
  const auto defect = new_vector(), mass = new_vector();
  space_.add(defects, defect);
  space_.add(masses, mass);
  AMT_PETSC(VecPointwiseDivide(defect, defect, mass));
  get(multipliers);
  AMT_PETSC(VecAXPY(multipliers, 1.0, defect));
}

} // namespace amontons
