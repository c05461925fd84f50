// Hyperelastic laws against closed forms in uniaxial stress and simple shear, and as potentials.
#include "material_points.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

namespace {

constexpr Elastic rubber{10, 0.3};

Tensor shear(double gamma) {
  Tensor F = Tensor::Identity();
  F(0, 1) = gamma;
  return F;
}
Tensor diagonal(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }
/// Kirchhoff stress P F^T.
template <class Law>
Tensor kirchhoff(const Law& law, const Tensor& F) {
  return law.piola(F) * F.transpose();
}

constexpr double stretches[] = {0.5, 0.8, 0.999999, 1.000001, 1.3, 2.0};
constexpr double shears[] = {-1.5, -1e-6, 1e-3, 0.4, 2.5};

} // namespace

TEST_CASE("St. Venant-Kirchhoff: uniaxial stress and simple shear") {
  const StVenantKirchhoff law{rubber};
  const auto [lambda, G] = law.lame();
  for (const double stretch : stretches) {
    const double green = (stretch * stretch - 1) / 2, lateral = std::sqrt(1 - 2 * rubber.poisson * green);
    const Tensor P = law.piola(diagonal(stretch, lateral, lateral));
    CHECK(P(0, 0) == Approx(stretch * rubber.young * green).epsilon(1e-9));
    CHECK(std::abs(P(1, 1)) + std::abs(P(2, 2)) < 1e-13);
  }
  for (const double gamma : shears) {
    const Tensor P = law.piola(shear(gamma));
    const double diagonal_part = lambda * gamma * gamma / 2;
    CHECK(P(0, 1) == Approx(G * gamma + gamma * (diagonal_part + G * gamma * gamma)).epsilon(1e-12));
    CHECK(P(2, 2) == Approx(diagonal_part).epsilon(1e-12));
  }
}

TEST_CASE("St. Venant-Kirchhoff: a confined bar is softest in compression at the stretch 1/sqrt(3)") {
  const StVenantKirchhoff law{rubber};
  const double at = 1 / std::sqrt(3.0);
  CHECK(std::abs(law.tangent(diagonal(at, 1, 1))(0, 0)) < 1e-14 * rubber.young);
}

TEST_CASE("Hencky: stress E ln(stretch) with lateral stretch^-nu; simple shear in closed form") {
  const Hencky law{rubber};
  const double G = G_of(rubber);
  for (const double stretch : stretches) {
    const double lateral = std::pow(stretch, -rubber.poisson);
    const Tensor P = law.piola(diagonal(stretch, lateral, lateral));
    CHECK(P(0, 0) * stretch == Approx(rubber.young * std::log(stretch)).epsilon(1e-9));
    CHECK(std::abs(P(1, 1)) + std::abs(P(2, 2)) < 1e-13);
  }
  // Principal stretches s, 1/s with γ = s − 1/s, that is ln s = asinh(γ/2), at half the angle whose tangent is 2/γ.
  for (const double gamma : shears) {
    const Tensor tau = kirchhoff(law, shear(gamma));
    const double size = 4 * G * std::asinh(gamma / 2) / std::sqrt(4 + gamma * gamma);
    CHECK(tau(0, 1) == Approx(size).epsilon(1e-12));
    CHECK(std::abs(tau(0, 0) - tau(1, 1) - size * gamma) < 1e-13 * (1 + gamma * gamma));
    CHECK(std::abs(tau(2, 2)) < 1e-14);
    CHECK(law.energy(shear(gamma)) == Approx(2 * G * std::pow(std::asinh(gamma / 2), 2)).epsilon(1e-9));
  }
}

TEST_CASE("Hencky: the shear stress has its maximum where x tanh x = 1, the force on a bar at the stretch e") {
  const Hencky law{rubber};
  const double x = 1.1996786402577339, gamma = 2 * std::sinh(x), e = std::exp(1.0);
  REQUIRE(x * std::tanh(x) == Approx(1).epsilon(1e-14));
  CHECK(std::abs(law.tangent(shear(gamma))(1, 1)) < 1e-13 * rubber.young);
  // Without lateral stress: condense the two lateral stretches out of the tangent.
  const double lateral = std::pow(e, -rubber.poisson);
  const PiolaTangent A = law.tangent(diagonal(e, lateral, lateral));
  const double condensed = A(0, 0) - 2 * A(0, 4) * A(4, 0) / (A(4, 4) + A(4, 8));
  CHECK(std::abs(A(0, 0)) > 0.01 * rubber.young);
  CHECK(std::abs(condensed) < 1e-13 * rubber.young);
}

TEST_CASE("neo-Hookean: simple shear keeps the volume and gives G gamma, with normal stress G gamma^2") {
  const NeoHookean law{rubber};
  const double G = G_of(rubber);
  for (const double gamma : shears) {
    const Tensor tau = kirchhoff(law, shear(gamma));
    CHECK(tau(0, 1) == Approx(G * gamma).epsilon(1e-12));
    CHECK(std::abs(tau(0, 0) - G * gamma * gamma) < 1e-13 * (1 + gamma * gamma));
    CHECK(std::abs(tau(1, 1)) + std::abs(tau(2, 2)) < 1e-13);
  }
}

TEST_CASE("neo-Hookean: hydrostatic stress of a swollen cube") {
  const NeoHookean law{rubber};
  const auto [lambda, G] = law.lame();
  for (const double s : stretches)
    CHECK(kirchhoff(law, s * Tensor::Identity())(1, 1) ==
          Approx(G * (s * s - 1) + 3 * lambda * std::log(s)).epsilon(1e-9));
}

TEST_CASE("Mooney-Rivlin: simple shear with both normal stress differences, and no mean stress") {
  const MooneyRivlin law{1.2, 0.5, 9};
  for (const double gamma : shears) {
    const Tensor tau = kirchhoff(law, shear(gamma));
    const double square = gamma * gamma;
    CHECK(tau(0, 1) == Approx(2 * (law.C_10 + law.C_01) * gamma).epsilon(1e-12));
    CHECK(std::abs(tau(0, 0) - tau(1, 1) - 2 * (law.C_10 + law.C_01) * square) < 1e-13 * (1 + square));
    CHECK(std::abs(tau(0, 0) - tau(2, 2) - 2 * law.C_10 * square) < 1e-13 * (1 + square));
    CHECK(std::abs(tau.trace()) < 1e-13 * (1 + square));
  }
}

TEST_CASE("Mooney-Rivlin: swelling is resisted by U alone, p = -U'") {
  const MooneyRivlin law{1.2, 0.5, 9};
  for (const double s : stretches) {
    const double J = s * s * s;
    const Tensor sigma = kirchhoff(law, s * Tensor::Identity()) / J;
    CHECK((sigma - law.K / 2 * (J - 1 / J) * Tensor::Identity()).norm() < 1e-13 * (1 + std::abs(law.K * (J - 1 / J))));
  }
}

TEST_CASE("rubber in uniaxial stress tends to the incompressible closed forms as 1/K") {
  for (const double stretch : {0.5, 0.8, 1.3, 2.0}) {
    const double C10 = 1.2, C01 = 0.5, G = 2 * (C10 + C01), shape = stretch - 1 / (stretch * stretch);
    const double mooney = 2 * shape * (C10 + C01 / stretch), hooke = G * shape;
    const auto error = [&](const FiniteLaw& law, double exact) {
      MaterialPoint<FiniteLaw> point(law);
      const double lateral = 1 / std::sqrt(stretch);
      const auto step = pull_bar(point, stretch, diagonal(stretch, lateral, lateral));
      REQUIRE(step.response.outcome == PointOutcome::Solved);
      return step.response.piola(0, 0) - exact;
    };
    const auto neo = [&](double ratio) { // λ = ratio G
      return NeoHookean{{G * (3 * ratio + 2) / (ratio + 1), ratio / (2 * (ratio + 1))}};
    };
    CAPTURE(stretch);
    CHECK(std::abs(error(MooneyRivlin{C10, C01, 1e6 * G}, mooney)) < 1e-5 * std::abs(mooney));
    CHECK(error(MooneyRivlin{C10, C01, 1e3 * G}, mooney) / error(MooneyRivlin{C10, C01, 1e4 * G}, mooney) ==
          Approx(10).epsilon(0.02));
    CHECK(std::abs(error(neo(1e6), hooke)) < 1e-5 * std::abs(hooke));
    CHECK(error(neo(1e3), hooke) / error(neo(1e4), hooke) == Approx(10).epsilon(0.02));
  }
}

TEST_CASE("P is the derivative of the energy: central differences in random directions") {
  for (const auto& [name, law] : sample_hyperelastics()) {
    CAPTURE(name);
    MaterialPoint<FiniteLaw> point(law);
    RandomStrain random(21);
    for (int i = 0; i < 100; ++i) {
      const Tensor F = random.gradient(0.4), direction = random.tensor(1);
      const double h = 1e-5, P = contract(point.respond(F).piola, direction);
      const auto W = [&](double s) { return point.respond(F + s * h * direction).stored; };
      const double fourth_order = (8 * (W(1) - W(-1)) - (W(2) - W(-2))) / (12 * h);
      CHECK(std::abs(fourth_order - P) < 1e-9 * point.tangent(F).norm());
      CHECK(point.tangent(F).norm() > 1);
    }
  }
}

TEST_CASE("path independence: work round closed polygons in F is zero, and not on its open parts") {
  constexpr double place[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                               0.2369268850561891};
  for (const auto& [name, law] : sample_hyperelastics()) {
    CAPTURE(name);
    MaterialPoint<FiniteLaw> point(law);
    RandomStrain random(22);
    for (int i = 0; i < 5; ++i) {
      std::vector<Tensor> corners;
      for (int k = 0; k < 4; ++k)
        corners.push_back(Tensor::Identity() + random.tensor(0.15));
      double total = 0, largest = 0;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Tensor from = corners[k], change = corners[(k + 1) % corners.size()] - from;
        double side = 0;
        constexpr int parts = 8;
        for (int part = 0; part < parts; ++part)
          for (int g = 0; g < 5; ++g)
            side += weight[g] / (2 * parts) *
                    contract(point.respond(from + (part + 0.5 * (1 + place[g])) / parts * change).piola, change);
        const double stored = point.respond(from + change).stored - point.respond(from).stored;
        CHECK(std::abs(side - stored) < 1e-9 * (std::abs(stored) + 1));
        total += side;
        largest = std::max(largest, std::abs(side));
      }
      CHECK(largest > 0.01);
      CHECK(std::abs(total) < 1e-9 * largest);
    }
  }
}

TEST_CASE("energy and stress have their digits down to tiny strains") {
  for (const auto& [name, law] : sample_hyperelastics()) {
    CAPTURE(name);
    MaterialPoint<FiniteLaw> point(law);
    const auto [lambda, G] = initial_lame(law);
    RandomStrain random(23);
    for (const double size : {1e-4, 1e-6, 1e-8}) {
      const Tensor F = Tensor::Identity() + random.tensor(size), H = F - Tensor::Identity();
      const Tensor E = 0.5 * (H + H.transpose());
      const double linear = lambda / 2 * E.trace() * E.trace() + G * E.squaredNorm();
      CHECK(point.respond(F).stored == Approx(linear).epsilon(30 * size + 1e-14 / size));
    }
  }
}
