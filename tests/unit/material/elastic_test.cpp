// Linear elasticity against uniaxial and hydrostatic states of the textbook, and against its own derivatives.
#include "base/error.hpp"
#include "material/elastic.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

namespace {
constexpr Elastic steel{210e3, 0.3};

Strain<2> strain_2d() { return {1.1e-3, -0.4e-3, 0.7e-3, 0.9e-3}; }
Strain<3> strain_3d() { return {1.1e-3, -0.4e-3, 0.7e-3, 0.9e-3, -0.3e-3, 0.2e-3}; }

/// Stress is the derivative of the energy and the moduli that of the stress. Energy is quadratic, so central
/// differences with any step are exact up to rounding.
template <int dim>
void check_derivatives(Space space, const Strain<dim>& strain) {
  const Lame lame = lame_constants(steel, space);
  const Stress<dim> stress = elastic_stress<dim>(lame, space, strain);
  const Moduli<dim> moduli = elastic_moduli<dim>(lame, space);
  REQUIRE(stress.norm() > 1);
  const double h = 1e-3;
  for (int i = 0; i < strain_size<dim>; ++i) {
    Strain<dim> plus = strain, minus = strain;
    plus[i] += h;
    minus[i] -= h;
    const double slope = (elastic_energy<dim>(lame, space, plus) - elastic_energy<dim>(lame, space, minus)) / (2 * h);
    const Stress<dim> column =
        (elastic_stress<dim>(lame, space, plus) - elastic_stress<dim>(lame, space, minus)) / (2 * h);
    CHECK(slope == Approx(stress[i]).epsilon(1e-10));
    CHECK((column - moduli.col(i)).norm() < 1e-9 * moduli.norm());
  }
}
} // namespace

TEST_CASE("uniaxial tension: sigma = E eps with lateral contraction nu") {
  const double stretch = 1e-3, lateral = -steel.poisson * stretch;
  const Stress<3> solid =
      elastic_stress<3>(lame_constants(steel, Space::Solid), Space::Solid, {stretch, lateral, lateral, 0, 0, 0});
  CHECK(solid[0] == Approx(steel.young * stretch));
  CHECK(solid.tail<5>().norm() < 1e-10);

  const Stress<2> plane =
      elastic_stress<2>(lame_constants(steel, Space::PlaneStress), Space::PlaneStress, {stretch, lateral, 0, 0});
  CHECK(plane[0] == Approx(steel.young * stretch));
  CHECK(plane.tail<3>().norm() < 1e-10);
  CHECK(plane_stress_zz_strain(steel, stretch, lateral) == Approx(lateral));
}

TEST_CASE("hydrostatic strain gives the bulk modulus, shear strain the shear modulus") {
  const Lame lame = lame_constants(steel, Space::Solid);
  const Stress<3> swollen = elastic_stress<3>(lame, Space::Solid, {1e-3, 1e-3, 1e-3, 0, 0, 0});
  CHECK(swollen[1] == Approx(steel.young / (3 * (1 - 2 * steel.poisson)) * 3e-3));
  const Stress<3> sheared = elastic_stress<3>(lame, Space::Solid, {0, 0, 0, 0, 2e-3, 0});
  CHECK(sheared[4] == Approx(steel.young / (2 * (1 + steel.poisson)) * 2e-3));
  CHECK(sheared.head<4>().norm() == 0);
}

TEST_CASE("plane strain: the out-of-plane stress is nu times the in-plane sum") {
  const Stress<2> stress =
      elastic_stress<2>(lame_constants(steel, Space::PlaneStrain), Space::PlaneStrain, {1.1e-3, -0.4e-3, 0, 0.9e-3});
  CHECK(stress[2] == Approx(steel.poisson * (stress[0] + stress[1])));
}

TEST_CASE("plane stress is solid elasticity with the free zz strain put in") {
  Strain<2> strain = strain_2d();
  const Stress<2> plane = elastic_stress<2>(lame_constants(steel, Space::PlaneStress), Space::PlaneStress, strain);
  strain[2] = plane_stress_zz_strain(steel, strain[0], strain[1]);
  const Stress<2> full = elastic_stress<2>(lame_constants(steel, Space::Axisymmetric), Space::Axisymmetric, strain);
  CHECK((plane - full).norm() < 1e-12 * plane.norm());
}

TEST_CASE("stress and moduli are the derivatives of the energy, in every space") {
  check_derivatives<2>(Space::PlaneStrain, strain_2d());
  check_derivatives<2>(Space::PlaneStress, strain_2d());
  check_derivatives<2>(Space::Axisymmetric, strain_2d());
  check_derivatives<3>(Space::Solid, strain_3d());
}

TEST_CASE("parameters outside their range are refused with the reason") {
  CHECK_THROWS_WITH_AS(lame_constants(Elastic{210e3, 0.5}, Space::Solid), doctest::Contains("0.4999"), UserError);
  CHECK_THROWS_WITH_AS(lame_constants(Elastic{-1, 0.3}, Space::Solid), doctest::Contains("positive"), UserError);
}
