// The multipliers of all pairs with `enforce: {uzawa: ...}` as one vector, for the outer loop.
#pragma once

#include "contact/contact_form.hpp"
#include "form/multiplier_set.hpp"

#include <vector>

namespace amontons {

class UzawaMultipliers : public MultiplierSet {
 public:
  /// The forms must outlive this object. Collective.
  UzawaMultipliers(const Mesh& mesh, std::vector<ContactForm*> pairs);

  VecHandle new_vector() const override { return space_.new_vector(); }
  void get(Vec multipliers) const override;
  void set(Vec multipliers) override;
  void updated(const State& state, Vec multipliers) override;

 private:
  static std::vector<NodeField> fields(const std::vector<ContactForm*>& pairs);
  std::vector<ContactForm*> pairs_;
  NodeSpace space_;
  VecHandle counts_; // how many ranks know each multiplier
};

} // namespace amontons
