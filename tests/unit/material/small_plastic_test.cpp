// Von Mises plasticity at small strain against closed forms: bars, shear, cycles, overstress, energies.
#include "material_points.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

namespace {

/// The strain of a bar in x that has the given stress and plastic strain.
Strain<3> bar_strain(const Elastic& elastic, double stress, double plastic_strain) {
  const double lateral = -elastic.poisson * stress / elastic.young - plastic_strain / 2;
  return {stress / elastic.young + plastic_strain, lateral, lateral, 0, 0, 0};
}
Strain<3> shear_strain(double gamma) { return {0, 0, 0, gamma, 0, 0}; }

} // namespace

TEST_CASE("uniaxial tension follows each hardening curve, in one increment or in many") {
  for (const auto& [name, material] : sample_plastics()) {
    if (material.rate) continue;
    CAPTURE(name);
    const double H = kinematic_modulus(material);
    for (const int increments : {1, 7}) {
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      for (int i = 1; i <= increments; ++i) {
        const double p = 0.3 * i / increments, stress = yield_stress(material.hardening, p) + H * p;
        const auto response = point.accept(bar_strain(material.elastic, stress, p));
        CHECK(response.stress[0] == Approx(stress).epsilon(1e-12));
        CHECK(response.stress.tail<5>().norm() < 1e-12);
        CHECK(point.p() == Approx(p).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("simple shear: tau = yield / sqrt(3), p = plastic shear / sqrt(3)") {
  for (const auto& [name, material] : sample_plastics()) {
    if (material.rate || material.kinematic) continue;
    CAPTURE(name);
    for (const double p : {0.005, 0.08, 1.0}) {
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      const double tau = yield_stress(material.hardening, p) / std::sqrt(3.0);
      const auto response = point.accept(shear_strain(tau / G_of(material.elastic) + std::sqrt(3.0) * p));
      CHECK(response.stress[3] == Approx(tau).epsilon(1e-12));
      CHECK(point.p() == Approx(p).epsilon(1e-12));
    }
  }
}

TEST_CASE("Bauschinger: with kinematic hardening yielding backwards begins 2 yield below the turning point") {
  ElasticPlastic material = plastic(LinearHardening{1, 0});
  material.kinematic = Prager{5};
  MaterialPoint<SmallLaw> point(SmallPlastic{material});
  const double turn = 1 + 5 * 0.1;
  point.accept(bar_strain(material.elastic, turn, 0.1));
  const double p = point.p();
  CHECK(point.respond(bar_strain(material.elastic, turn - 2 + 1e-9, 0.1)).dissipated == 0);
  CHECK(point.respond(bar_strain(material.elastic, turn - 2 - 1e-9, 0.1)).dissipated > 0);
  point.accept(bar_strain(material.elastic, turn - 2 - 5 * 0.04, 0.06));
  CHECK(point.p() == Approx(p + 0.04).epsilon(1e-12));
}

TEST_CASE("cycles: stress = sign yield(p) + H_kin ep at every turning point of any hardening") {
  for (auto [name, material] : sample_plastics()) {
    if (material.rate) continue;
    CAPTURE(name);
    for (const double H : {0.0, 6.0}) {
      material.kinematic.reset();
      if (H > 0) material.kinematic = Prager{H};
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      double plastic_strain = 0, p = 0, dissipated = 0, expected = 0;
      for (const double target : {0.02, -0.03, 0.01, -0.2, 0.15}) {
        const double sign = target > plastic_strain ? 1 : -1, p_old = p;
        p += std::abs(target - plastic_strain);
        plastic_strain = target;
        const double stress = sign * yield_stress(material.hardening, p) + H * target;
        const auto response = point.accept(bar_strain(material.elastic, stress, target));
        CHECK(response.stress[0] == Approx(stress).epsilon(1e-11));
        CHECK(response.stress.tail<5>().norm() < 1e-12);
        CHECK(point.p() == Approx(p).epsilon(1e-12));
        CHECK(response.stored ==
              Approx(stress * stress / (2 * material.elastic.young) + H / 2 * target * target).epsilon(1e-10));
        dissipated += response.dissipated;
        expected += hardening_work(material.hardening, p_old, p);
      }
      CHECK(dissipated == Approx(expected).epsilon(1e-12));
    }
  }
}

TEST_CASE("energy balance of smooth three-dimensional paths: work = stored + dissipated as increments shrink") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    const auto gap = [&](int n) {
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      Strain<3> old = Strain<3>::Zero();
      SmallResponse before;
      double balance = 0;
      for (int i = 1; i <= n; ++i) {
        const double t = 2.0 * i / n;
        const Strain<3> strain{0.05 * std::sin(3 * t),  -0.03 * t, 0.02 * t * t, 0.08 * t,
                               -0.05 * std::sin(2 * t), 0.03 * t};
        const auto response = point.accept(strain, 2.0 / n);
        balance += 0.5 * work(before, strain - old) + 0.5 * work(response, strain - old) - response.dissipated;
        before = response;
        old = strain;
      }
      CHECK(before.stored > 1e-3);
      return std::abs(balance - before.stored) / before.stored;
    };
    const double coarse = gap(800), fine = gap(1600);
    CHECK(fine < (material.rate ? 2e-3 : 2e-4));
    CHECK(fine < (material.rate ? 0.52 : 0.36) * coarse); // order 1, and nearly 2
  }
}

TEST_CASE("Perzyna: steady shear at constant rate has the overstress of the law, for any increment") {
  for (const double n : {1.0, 3.0, 8.0})
    for (const double dt : {1e-3, 1.0}) {
      ElasticPlastic material = plastic(LinearHardening{1, 0});
      material.rate = Perzyna{0.4, n};
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      const double rate = 3.0; // γ per time
      SmallResponse response;
      for (int i = 1; i <= 2000; ++i)
        response = point.accept(shear_strain(rate * dt * i), dt);
      const double overstress = std::pow(rate / std::sqrt(3.0) / 0.4, 1 / n);
      CHECK(response.stress[3] == Approx((1 + overstress) / std::sqrt(3.0)).epsilon(1e-9));
      CHECK(response.dissipated == Approx(response.stress[3] * rate * dt).epsilon(1e-9));
    }
}

TEST_CASE("Perzyna with n = 1: relaxation is exponential, and the increments converge to it with order 1") {
  ElasticPlastic material = plastic(LinearHardening{1, 0});
  material.rate = Perzyna{0.4, 1};
  const double G = G_of(material.elastic), gamma = 3 / (std::sqrt(3.0) * G), time = 0.02; // q = 3 at once
  const double exact = 1 + 2 * std::exp(-3 * G * 0.4 * time);
  const auto error = [&](int n) {
    MaterialPoint<SmallLaw> point(SmallPlastic{material});
    CHECK(point.accept(shear_strain(gamma), 0).stress[3] * std::sqrt(3.0) ==
          Approx(3).epsilon(1e-12)); // no time, no flow
    double q = 0;
    for (int i = 0; i < n; ++i)
      q = std::sqrt(3.0) * point.accept(shear_strain(gamma), time / n).stress[3];
    return q - exact;
  };
  CHECK(exact < 2);
  CHECK(error(400) < 1e-3);
  CHECK(error(200) / error(400) == Approx(2).epsilon(0.01));
}

TEST_CASE("Perzyna between its limits: rate-independent for long increments, elastic for short ones, always solved") {
  RandomStrain random(31);
  for (int i = 0; i < 2000; ++i) {
    ElasticPlastic material = plastic(VoceHardening{1, 0.8, 12, 0.3});
    const double n = random.between(1, 20), D = std::pow(10, random.between(-30, 30));
    material.rate = Perzyna{D, n};
    MaterialPoint<SmallLaw> point(SmallPlastic{material});
    const Strain<3> strain = random.strain(0.2);
    const auto response = point.accept(strain);
    REQUIRE(response.outcome == PointOutcome::Solved);
    const double q = von_mises({response.stress.data(), 6}), yield = yield_stress(material.hardening, point.p());
    CHECK(q / yield == Approx(1 + std::pow(point.p() / D, 1 / n)).epsilon(1e-10));
  }
  const Strain<3> strain{0.1, -0.02, 0.03, 0.05, 0, 0.02};
  ElasticPlastic slow = plastic(VoceHardening{1, 0.8, 12, 0.3}), elastic = slow, rigid = slow;
  slow.rate = elastic.rate = Perzyna{1, 2};
  MaterialPoint<SmallLaw> a(SmallPlastic{slow}), b(SmallPlastic{rigid}), c(SmallPlastic{elastic});
  const auto limit = b.respond(strain).stress;
  CHECK((a.respond(strain, 1e20).stress - limit).norm() < 1e-9 * limit.norm());
  CHECK((c.respond(strain, 0).stress -
         elastic_stress<3>(lame_constants(slow.elastic, Space::Solid), Space::Solid, strain))
            .norm() < 1e-12);
}

TEST_CASE("evaluating an accepted strain again changes nothing, and the moduli are then elastic") {
  for (auto [name, material] : sample_plastics())
    for (const double young : {100.0, 1e5}) {
      if (material.rate) continue; // creeps on
      CAPTURE(name);
      material.elastic.young = young;
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      RandomStrain random(32);
      for (int i = 0; i < 50; ++i) {
        const Strain<3> strain = random.strain(0.1);
        const auto first = point.accept(strain);
        const auto state = point.state();
        const auto again = point.accept(strain);
        CHECK((first.stress - again.stress).norm() < 1e-12 * first.stress.norm());
        CHECK(again.dissipated == 0);
        CHECK(point.state() == state);
        const Lame lame = lame_constants(material.elastic, Space::Solid);
        CHECK((point.moduli(strain) - elastic_moduli<3>(lame, Space::Solid)).norm() < 1e-11 * lame.lambda);
      }
    }
}
