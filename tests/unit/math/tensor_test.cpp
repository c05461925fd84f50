// The von Mises stress against uniaxial, shear and hydrostatic states.
#include "math/tensor.hpp"

#include <array>
#include <doctest/doctest.h>

using amontons::von_mises;

TEST_CASE("von Mises stress: uniaxial s, shear sqrt(3) s, pressure nothing") {
  CHECK(von_mises(std::array{0.0, -5.0, 0.0, 0.0}) == doctest::Approx(5.0));
  CHECK(von_mises(std::array{0.0, 0.0, 0.0, 2.0}) == doctest::Approx(2 * std::sqrt(3.0)));
  CHECK(von_mises(std::array{0.0, 0.0, 0.0, 0.0, 0.0, 2.0}) == doctest::Approx(2 * std::sqrt(3.0)));
  CHECK(von_mises(std::array{3.0, 3.0, 3.0, 0.0, 0.0, 0.0}) == 0);
  CHECK(von_mises(std::array{10.0, 3.0, 3.0, 0.0}) == doctest::Approx(7.0));
}
