// Von Mises plasticity at finite strain against closed forms in logarithmic strain, and its structure: isochoric flow,
// repeated evaluation, the small-strain law as limit.
#include "material_points.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <numbers>

using namespace amontons;
using doctest::Approx;

namespace {

Tensor shear(double gamma) {
  Tensor F = Tensor::Identity();
  F(0, 1) = gamma;
  return F;
}
/// F of a bar in x with Kirchhoff stress τ and plastic strain ε_p: ln stretches of Hencky elasticity and isochoric
/// flow.
Tensor bar_gradient(const Elastic& elastic, double tau, double plastic_strain) {
  const double axial = tau / elastic.young + plastic_strain;
  const double lateral = -elastic.poisson * tau / elastic.young - plastic_strain / 2;
  return Eigen::Vector3d(std::exp(axial), std::exp(lateral), std::exp(lateral)).asDiagonal();
}
double plastic_ratio(const std::vector<double>& state) { return 1 / unflat(&state[1]).determinant(); }

} // namespace

TEST_CASE("tension and compression: Kirchhoff stress follows each hardening curve over logarithmic plastic strain") {
  for (const auto& [name, material] : sample_plastics()) {
    if (material.rate) continue;
    CAPTURE(name);
    for (const double sign : {1.0, -1.0})
      for (const int increments : {1, 10}) {
        MaterialPoint<FiniteLaw> point(FinitePlastic{material});
        for (int i = 1; i <= increments; ++i) {
          const double p = 1.2 * i / increments;
          const double tau = sign * (yield_stress(material.hardening, p) + kinematic_modulus(material) * p);
          const Tensor F = bar_gradient(material.elastic, tau, sign * p);
          const auto response = point.accept(F);
          const Tensor kirchhoff = response.piola * F.transpose();
          CHECK(kirchhoff(0, 0) == Approx(tau).epsilon(1e-11));
          CHECK((kirchhoff - tau * Eigen::Vector3d::UnitX() * Eigen::RowVector3d::UnitX()).norm() < 1e-11);
          CHECK(point.p() == Approx(p).epsilon(1e-11));
        }
      }
  }
}

TEST_CASE("frictionless upsetting: force and radius of a billet without lateral stress, found by iteration") {
  // Derived: p = (E ε − σ0) / (E + H), τ = σ0 + H p, J = exp(−(1 − 2 nu) τ / E), F = τ / (stretch) π r0².
  const ElasticPlastic steel{
      .elastic = {200e3, 0.3}, .hardening = LinearHardening{700, 300}, .kinematic = {}, .rate = {}};
  struct Row {
    double reduction, radius, kilonewton;
  };
  constexpr Row table[] = {{0.1, 10.53323, 254.9969}, {0.2, 11.17178, 300.7267}, {0.3, 11.94266, 361.6394},
                           {0.4, 12.89895, 446.0903}, {0.5, 14.12932, 569.6237}, {0.6, 15.79600, 764.5278}};
  MaterialPoint<FiniteLaw> point(FinitePlastic{steel});
  Tensor F = Tensor::Identity();
  for (const auto& [reduction, radius, kilonewton] : table) {
    const double guess = std::sqrt(F(0, 0) / (1 - reduction)) * F(1, 1);
    F(1, 1) = F(2, 2) = guess;
    const auto step = pull_bar(point, 1 - reduction, F);
    REQUIRE(step.response.outcome == PointOutcome::Solved);
    CHECK(step.iterations <= 8);
    F = step.F;
    CHECK(-step.response.piola(0, 0) * std::numbers::pi * 100 == Approx(kilonewton * 1e3).epsilon(1e-6));
    CHECK(10 * F(1, 1) == Approx(radius).epsilon(1e-6));
    CHECK(F(1, 1) == Approx(F(2, 2)).epsilon(1e-9));
  }
}

TEST_CASE("large simple shear without kinematic hardening: tau = yield(gamma / sqrt(3)) / sqrt(3) but for elasticity") {
  const auto error = [](double young) {
    ElasticPlastic material = plastic(LinearHardening{1, 0.6});
    material.elastic.young = young;
    MaterialPoint<FiniteLaw> point(FinitePlastic{material});
    double worst = 0;
    for (int i = 1; i <= 4000; ++i) {
      const double gamma = 1e-3 * i;
      const Tensor tau = point.accept(shear(gamma)).piola * shear(gamma).transpose();
      const double exact = (1 + 0.6 * gamma / std::sqrt(3.0)) / std::sqrt(3.0);
      if (i > 500) worst = std::max(worst, std::abs(tau(0, 1) - exact));
    }
    return worst;
  };
  CHECK(error(1e5) < 1e-4);
  CHECK(error(1e3) < 1e-2);
  CHECK(error(1e3) > 10 * error(1e5)); // what is left is elastic
}

TEST_CASE("large simple shear with kinematic hardening: backstress turns as the docstring says, H/3 sin(gamma)") {
  ElasticPlastic material = plastic(LinearHardening{1, 0});
  material.elastic.young = 1e5;
  material.kinematic = Prager{3};
  MaterialPoint<FiniteLaw> point(FinitePlastic{material});
  double most = 0;
  for (int i = 1; i <= 4000; ++i) {
    const double gamma = 1e-3 * i;
    const Tensor tau = point.accept(shear(gamma)).piola * shear(gamma).transpose();
    if (i < 100) continue;
    most = std::max({most, std::abs(tau(0, 1) - 1 / std::sqrt(3.0) - std::sin(gamma)),
                     std::abs(tau(0, 0) - 1 + std::cos(gamma)), std::abs(tau(1, 1) + 1 - std::cos(gamma))});
  }
  CHECK(most < 2e-3);
}

TEST_CASE("Bauschinger at finite strain: a bar pulled to 0.3 yields backwards 2 yield below") {
  ElasticPlastic material = plastic(LinearHardening{1, 0});
  material.kinematic = Prager{2};
  MaterialPoint<FiniteLaw> point(FinitePlastic{material});
  const double turn = 1 + 2 * 0.3;
  point.accept(bar_gradient(material.elastic, turn, 0.3));
  CHECK(point.respond(bar_gradient(material.elastic, turn - 2 + 1e-9, 0.3)).dissipated == 0);
  CHECK(point.respond(bar_gradient(material.elastic, turn - 2 - 1e-9, 0.3)).dissipated > 0);
}

TEST_CASE("Perzyna at finite strain: overstress of a bar stretched at a constant logarithmic rate") {
  ElasticPlastic material = plastic(LinearHardening{1, 0});
  material.rate = Perzyna{0.4, 3};
  MaterialPoint<FiniteLaw> point(FinitePlastic{material});
  const double rate = 2, dt = 0.01;
  Tensor F = Tensor::Identity();
  BarStep step;
  for (int i = 1; i <= 100; ++i) {
    F(1, 1) = F(2, 2) = F(1, 1) * std::exp(-0.5 * rate * dt);
    step = pull_bar(point, std::exp(rate * dt * i), F, dt);
    REQUIRE(step.response.outcome == PointOutcome::Solved);
    F = step.F;
  }
  const double tau = step.response.piola(0, 0) * F(0, 0);
  CHECK(tau == Approx(1 + std::cbrt(rate / 0.4)).epsilon(1e-6));
}

TEST_CASE("plastic flow keeps the volume to rounding over a thousand random increments") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    MaterialPoint<FiniteLaw> point(FinitePlastic{material});
    RandomStrain random(41);
    for (int i = 0; i < 1000; ++i)
      point.accept(random.gradient(0.3));
    CHECK(point.p() > 5);
    CHECK(std::abs(plastic_ratio(point.state()) - 1) < 1e-11);
  }
}

TEST_CASE("evaluating an accepted F again changes neither stress nor state, also with kinematic hardening") {
  for (auto [name, material] : sample_plastics())
    for (const double young : {100.0, 1e5}) {
      if (material.rate) continue; // creeps on
      CAPTURE(name);
      material.elastic.young = young;
      MaterialPoint<FiniteLaw> point(FinitePlastic{material});
      RandomStrain random(42);
      for (int i = 0; i < 100; ++i) {
        const Tensor F = random.gradient(0.5);
        const auto first = point.accept(F);
        const auto state = point.state();
        const auto again = point.accept(F);
        CHECK((first.piola - again.piola).norm() < 1e-11 * material.elastic.young);
        CHECK(again.dissipated == 0);
        CHECK(point.state() == state);
      }
    }
}

TEST_CASE("the small-strain law is the limit: difference of second order in the strain") {
  for (auto [name, material] : sample_plastics()) {
    CAPTURE(name);
    RandomStrain random(43);
    const Tensor H1 = random.tensor(1), H2 = random.tensor(1);
    // Yield stresses of the order of the strain, so that every size of strain flows.
    const auto difference = [&](double size) {
      ElasticPlastic scaled = material;
      scaled.hardening = LinearHardening{20 * size, 5};
      MaterialPoint<FiniteLaw> finite(FinitePlastic{scaled});
      MaterialPoint<SmallLaw> small(SmallPlastic{scaled});
      double worst = 0;
      for (const Tensor& H : {H1, H2}) {
        const auto sigma = small.accept(strain_vector(0.5 * size * (H + H.transpose())));
        const auto P = finite.accept(Tensor::Identity() + size * H);
        CHECK(sigma.dissipated > 0);
        worst =
            std::max(worst, (P.piola - strain_tensor(sigma.stress.cwiseProduct(Stress<3>{1, 1, 1, 2, 2, 2}))).norm());
        CHECK(finite.p() == Approx(small.p()).epsilon(20 * size));
      }
      return worst;
    };
    CHECK(difference(1e-4) > 1e-9);
    CHECK(difference(1e-3) / difference(1e-4) == Approx(100).epsilon(0.1));
    CHECK(difference(1e-4) / difference(1e-5) == Approx(100).epsilon(0.1));
  }
}

TEST_CASE("energy balance of a path with large rotation: work of P = stored + dissipated as increments shrink") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    const auto gap = [&](int n) {
      MaterialPoint<FiniteLaw> point(FinitePlastic{material});
      Tensor old = Tensor::Identity();
      FiniteResponse before;
      double balance = 0;
      for (int i = 1; i <= n; ++i) {
        const double t = 1.0 * i / n;
        Tensor A;
        A << 0.3 * t, 0.5 * t, 0, 0, -0.2 * t, 0.3 * t * t, 0.2 * t, 0, -0.1 * t;
        const Tensor F = Eigen::AngleAxisd(2 * t, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix() *
                         (Tensor::Identity() + A);
        const auto response = point.accept(F, 1.0 / n);
        balance += 0.5 * (work(before, F - old) + work(response, F - old)) - response.dissipated;
        before = response;
        old = F;
      }
      CHECK(before.stored > 1e-3);
      CHECK(point.p() > 0.1);
      return std::abs(balance - before.stored) / before.stored;
    };
    const double coarse = gap(800), fine = gap(1600);
    CHECK(fine < (material.rate ? 2e-3 : 2e-4));
    CHECK(fine < (material.rate ? 0.52 : 0.36) * coarse); // order 1, and nearly 2
  }
}
