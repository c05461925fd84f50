// The deck's pair E, nu, which several materials have.
#pragma once

#include "deck/rule.hpp"
#include "material/elastic.hpp"

#include <functional>

namespace amontons {

/// The required keys E and nu; `get` (a member pointer, or std::identity) takes a Law to its Elastic.
template <class Law, class Get>
ObjectRule<Law> elastic_rule(Get get) {
  return ObjectRule<Law>()
      .required(
          "E", [get](auto& law) -> auto& { return std::invoke(get, law).young; }, number("stress", Range::above(0)),
          "Young's modulus at zero strain.")
      .required(
          "nu", [get](auto& law) -> auto& { return std::invoke(get, law).poisson; },
          number("1", Range::inside(-1, 0.5)), "Poisson's ratio at zero strain; 0.4999 is nearly incompressible.");
}

} // namespace amontons
