// What holds for every law: consistent tangents, symmetry, objectivity, isotropy, the linear elastic limit,
// dissipation, failures as values, batches.
#include "material_points.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace amontons;
using doctest::Approx;

namespace {

/// Moves a point along a few random increments.
void walk(MaterialPoint<FiniteLaw>& point, RandomStrain& random, Tensor& F) {
  for (int i = 0; i < 3; ++i) {
    F = (Tensor::Identity() + random.tensor(0.05)) * F;
    point.accept(F, 0.1);
  }
}

Tensor applied(const PiolaTangent& A, const Tensor& direction) {
  const Eigen::Matrix<double, 9, 1> product = A * flat(direction);
  return unflat(product.data());
}

bool is_plastic(const FiniteLaw& law) { return std::holds_alternative<FinitePlastic>(law); }

/// Compares the tangent at F with central differences; false where a kink is nearby.
bool check_tangent(MaterialPoint<FiniteLaw>& point, const Tensor& F) {
  const double h = 1e-6;
  const PiolaTangent A = point.tangent(F, 0.1);
  REQUIRE(point.outcome() == PointOutcome::Solved);
  REQUIRE(A.norm() > 1);
  const Tensor middle = point.respond(F, 0.1).piola;
  PiolaTangent difference;
  for (int i = 0; i < 9; ++i) {
    Tensor step = Tensor::Zero();
    step(i / 3, i % 3) = h;
    const Tensor plus = point.respond(F + step, 0.1).piola, minus = point.respond(F - step, 0.1).piola;
    if ((plus - 2 * middle + minus).norm() > 1e-3 * h * A.norm()) return false;
    difference.col(i) = flat(plus - minus) / (2 * h);
  }
  CHECK((A - difference).norm() < 1e-8 * A.norm());
  return true;
}

} // namespace

TEST_CASE("dP/dF agrees with central differences at random points, elastic and flowing") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(51);
    int smooth = 0, flowing = 0;
    for (int i = 0; i < 60; ++i) {
      MaterialPoint<FiniteLaw> point(law);
      Tensor F = random.gradient(0.3);
      walk(point, random, F);
      F = (Tensor::Identity() + random.tensor(i % 3 == 0 ? 1e-4 : 0.1)) * F;
      smooth += check_tangent(point, F);
      flowing += point.respond(F, 0.1).dissipated > 0;
    }
    CHECK(smooth >= 57);
    if (is_plastic(law)) CHECK(flowing > 20);
    if (is_plastic(law) && !std::get<FinitePlastic>(law).material.rate) CHECK(flowing < 60);
  }
}

TEST_CASE("dP/dF where stretches coalesce, exactly and nearly") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(52);
    for (const double gap : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3})
      for (const double base : {0.9, 1.3}) {
        MaterialPoint<FiniteLaw> point(law);
        const Tensor Q = random.rotation(), R = random.rotation();
        CAPTURE(gap);
        for (const auto& stretch :
             {Eigen::Vector3d(base, base + gap, base - gap), Eigen::Vector3d(base, base + gap, 1.1)})
          CHECK(check_tangent(point, R * Q * stretch.asDiagonal() * Q.transpose()));
      }
    // The reference state itself, where viscous flow has not begun: elastic moduli.
    MaterialPoint<FiniteLaw> point(law);
    const auto [lambda, G] = initial_lame(law);
    const PiolaTangent A = point.tangent(Tensor::Identity());
    for (int i = 0; i < 9; ++i)
      for (int k = 0; k < 9; ++k) {
        const int a = i / 3, b = i % 3, c = k / 3, d = k % 3;
        const double elastic = lambda * (a == b) * (c == d) + G * ((a == c) * (b == d) + (a == d) * (b == c));
        CHECK(std::abs(A(i, k) - elastic) < 1e-12 * (lambda + G));
      }
  }
}

TEST_CASE("Taylor: P is linearized with a remainder of second order over three decades") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(53);
    int seen = 0;
    for (int i = 0; i < 10; ++i) {
      MaterialPoint<FiniteLaw> point(law);
      Tensor F = random.gradient(0.2);
      walk(point, random, F);
      // A large increment along the last one flows for certain; elastic laws do not mind.
      F = (Tensor::Identity() + random.tensor(0.2)) * F;
      const Tensor direction = random.tensor(0.5);
      const Tensor P = point.respond(F, 0.1).piola, linear = applied(point.tangent(F, 0.1), direction);
      const auto remainder = [&](double h) {
        return (point.respond(F + h * direction, 0.1).piola - P - h * linear).norm();
      };
      REQUIRE(linear.norm() > 0.1);
      const double scale = remainder(1e-2) * 1e4;
      if (!(scale < 100 * linear.norm())) continue; // across a kink
      ++seen;
      for (const double h : {1e-3, 1e-4, 1e-5})
        CHECK(remainder(h) < 3 * scale * h * h + 1e-13 * point.tangent(F, 0.1).norm());
      CHECK(remainder(1e-3) > 1e-2 * scale * 1e-6);
    }
    CHECK(seen >= 8);
  }
}

TEST_CASE("dP/dF is symmetric exactly where the law says so") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(54);
    double skewest = 0;
    for (int i = 0; i < 50; ++i) {
      MaterialPoint<FiniteLaw> point(law);
      Tensor F = random.gradient(0.4);
      walk(point, random, F);
      F = (Tensor::Identity() + random.tensor(0.1)) * F;
      const PiolaTangent A = point.tangent(F, 0.1);
      skewest = std::max(skewest, (A - A.transpose()).norm() / A.norm());
    }
    if (has_symmetric_tangent(law))
      CHECK(skewest < 1e-12);
    else
      CHECK((skewest > 1e-6 && skewest < 0.01)); // of the order of the yield strain
  }
}

TEST_CASE("objectivity: P(Q F) = Q P(F) along a path with a rotation of its own in every increment") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(55);
    MaterialPoint<FiniteLaw> still(law), turned(law);
    Tensor F = Tensor::Identity();
    for (int i = 0; i < 100; ++i) {
      F = (Tensor::Identity() + random.tensor(0.05)) * F;
      F /= std::cbrt(F.determinant());
      const Tensor Q = random.rotation();
      const auto a = still.accept(F, 0.1), b = turned.accept(Q * F, 0.1);
      REQUIRE(a.outcome == PointOutcome::Solved);
      CHECK((Q * a.piola - b.piola).norm() < 1e-10 * still.tangent(F, 0.1).norm() * (1 + F.norm()));
      CHECK(std::abs(a.stored - b.stored) < 1e-10 * (1 + a.stored));
      CHECK(std::abs(a.dissipated - b.dissipated) < 1e-10);
      const Tensor tau = a.piola * F.transpose();
      CHECK((tau - tau.transpose()).norm() < 1e-12 * (1 + tau.norm()) * still.tangent(F, 0.1).norm());
    }
  }
}

TEST_CASE("isotropy: P(F Q) = P(F) Q from the virgin state, along a path in turned axes") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(56);
    const Tensor Q = random.rotation();
    MaterialPoint<FiniteLaw> still(law), turned(law);
    Tensor F = Tensor::Identity();
    for (int i = 0; i < 20; ++i) {
      F = (Tensor::Identity() + random.tensor(0.05)) * F;
      CHECK((still.accept(F, 0.1).piola * Q - turned.accept(F * Q, 0.1).piola).norm() <
            1e-11 * still.tangent(F, 0.1).norm());
    }
  }
}

TEST_CASE("at small strain every law is linear elasticity: difference of second order") {
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    MaterialPoint<FiniteLaw> point(law);
    RandomStrain random(57);
    const auto [lambda, G] = initial_lame(law);
    const Tensor H = random.tensor(1), E = 0.5 * (H + H.transpose());
    const Tensor sigma = lambda * E.trace() * Tensor::Identity() + 2 * G * E;
    const auto difference = [&](double size) {
      return (point.respond(Tensor::Identity() + size * H).piola - size * sigma).norm();
    };
    CHECK(difference(1e-3) > 1e-8);
    CHECK(difference(1e-3) / difference(1e-4) == Approx(100).epsilon(0.1));
    CHECK(point.respond(Tensor::Identity()).piola.norm() == 0);
    CHECK(point.respond(Tensor::Identity()).stored == 0);
  }
}

TEST_CASE("dissipation is never negative and plastic strain never shrinks: thousands of random paths") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    RandomStrain random(58);
    for (int path = 0; path < 250; ++path) {
      MaterialPoint<SmallLaw> small(SmallPlastic{material});
      MaterialPoint<FiniteLaw> finite(FinitePlastic{material});
      double total = 0;
      const double size = std::pow(10, random.between(-3, -0.5));
      for (int i = 0; i < 12; ++i) {
        const double dt = random.between(0, 1), small_p = small.p(), finite_p = finite.p();
        const auto a = small.accept(random.strain(size), dt);
        const auto b = finite.accept(random.gradient(size), dt);
        REQUIRE(a.outcome == PointOutcome::Solved);
        REQUIRE(b.outcome == PointOutcome::Solved);
        CHECK((a.dissipated >= 0 && b.dissipated >= 0 && a.stored >= 0 && b.stored >= 0));
        CHECK((small.p() >= small_p && finite.p() >= finite_p));
        total += a.dissipated + b.dissipated;
      }
      if (size > 0.1) CHECK(total > 0);
    }
  }
}

TEST_CASE("small strain: moduli by central differences, symmetric, elastic and flowing") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    RandomStrain random(59);
    int smooth = 0, flowing = 0;
    for (int i = 0; i < 60; ++i) {
      MaterialPoint<SmallLaw> point(SmallPlastic{material});
      for (int k = 0; k < 3; ++k)
        point.accept(random.strain(0.02), 0.1);
      const Strain<3> strain = random.strain(i % 3 == 0 ? 0.003 : 0.03);
      const Moduli<3> C = point.moduli(strain, 0.1);
      CHECK((C - C.transpose()).norm() < 1e-13 * C.norm());
      const double h = 1e-7;
      Moduli<3> difference;
      bool kinks = false;
      for (int k = 0; k < 6; ++k) {
        const Strain<3> step = h * Strain<3>::Unit(k);
        const Stress<3> plus = point.respond(strain + step, 0.1).stress,
                        minus = point.respond(strain - step, 0.1).stress;
        kinks = kinks || (plus - 2 * point.respond(strain, 0.1).stress + minus).norm() > 1e-3 * h * C.norm();
        difference.col(k) = (plus - minus) / (2 * h);
      }
      if (kinks) continue;
      ++smooth;
      CHECK((C - difference).norm() < 1e-7 * C.norm());
      flowing += point.respond(strain, 0.1).dissipated > 0;
    }
    CHECK(smooth >= 57);
    CHECK((flowing > 20 && flowing < 60));
  }
}

TEST_CASE("failures are values: inverted, not finite, out of range; no NaN comes out and the state stays") {
  const double huge = std::numeric_limits<double>::max(), infinity = std::numeric_limits<double>::infinity();
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    RandomStrain random(60);
    MaterialPoint<FiniteLaw> point(law);
    point.accept(random.gradient(0.3));
    const auto state = point.state();
    const auto ends = [&](const Tensor& F) {
      const auto response = point.accept(F);
      const auto outcome = response.outcome;
      CHECK(response.piola.allFinite());
      CHECK(std::isfinite(response.stored));
      CHECK(point.tangent(F).allFinite());
      if (outcome != PointOutcome::Solved) {
        CHECK(point.state() == state);
        CHECK(response.piola.norm() == 0);
        CHECK(point.outcome() == outcome);
      }
      return outcome;
    };
    CHECK(ends(Tensor::Zero()) == PointOutcome::Inverted);
    CHECK(ends(-Tensor::Identity()) == PointOutcome::Inverted);
    CHECK(ends(Eigen::Vector3d(1, 1, -1e-3).asDiagonal()) == PointOutcome::Inverted);
    CHECK(ends(Tensor::Constant(std::nan(""))) == PointOutcome::NotFinite);
    CHECK(ends(Eigen::Vector3d(1, infinity, 1).asDiagonal()) == PointOutcome::NotFinite);
    CHECK(ends(Eigen::Vector3d(huge, huge, huge).asDiagonal()) != PointOutcome::Solved);
    CHECK(ends(Eigen::Vector3d(1e200, 1e-200, 1).asDiagonal()) != PointOutcome::Solved);
    CHECK(ends(Eigen::Vector3d(1e-300, 1, 1).asDiagonal()) != PointOutcome::NotConverged);
  }
  CHECK(outcome_text(PointOutcome::Inverted) == "det F is not positive");
  CHECK(outcome_text(PointOutcome::NotFinite) != outcome_text(PointOutcome::NotConverged));
  for (const auto& [name, material] : sample_plastics()) {
    MaterialPoint<SmallLaw> point(SmallPlastic{material});
    point.accept(Strain<3>::Constant(0.05));
    const auto state = point.state();
    for (const double bad : {std::nan(""), infinity, huge}) {
      const auto response = point.accept(Strain<3>::Constant(bad));
      CHECK(response.outcome == PointOutcome::NotFinite);
      CHECK(response.stress.norm() == 0);
      CHECK(point.state() == state);
    }
  }
}

TEST_CASE("violent single increments are solved, and lie on the yield surface to the digits that log_strain promises") {
  for (const auto& [name, material] : sample_plastics()) {
    CAPTURE(name);
    RandomStrain random(61);
    double widest = 0;
    for (int i = 0; i < 200; ++i) {
      MaterialPoint<FiniteLaw> point(FinitePlastic{material});
      const Tensor F = random.gradient(2);
      const auto response = point.accept(F);
      REQUIRE(response.outcome == PointOutcome::Solved);
      if (material.kinematic || material.rate) continue;
      const Eigen::Vector3d stretch = Eigen::JacobiSVD<Tensor>(F).singularValues();
      const double ratio = std::max(1.0, stretch[0]) / stretch[2], strain_error = 5e-15 * ratio * ratio;
      const Stress<3> tau = stress_vector(response.piola * F.transpose());
      const double yield = yield_stress(material.hardening, point.p());
      CHECK(std::abs(von_mises({tau.data(), 6}) - yield) < 1e-12 * yield + 3 * G_of(material.elastic) * strain_error);
      widest = std::max(widest, ratio);
    }
    if (!material.kinematic && !material.rate) CHECK(widest > 50);
  }
}

TEST_CASE("batches are the points one by one, and name the first that fails") {
  RandomStrain random(62);
  for (const auto& [name, law] : sample_finite_laws()) {
    CAPTURE(name);
    constexpr std::size_t n = 5;
    const std::size_t states = state_names(law).size();
    std::vector<double> F(9 * n), piola(9 * n), stored(n), dissipated(n), old(states * n), now(states * n),
        tangents_out(81 * n);
    std::vector<double> one(states);
    for (std::size_t i = 0; i < n; ++i) {
      const Tensor gradient = random.gradient(0.3);
      Eigen::Map<Eigen::Matrix<double, 9, 1>>{&F[9 * i]} = flat(gradient);
      initial_state(law, std::span(old).subspan(i * states, states));
    }
    REQUIRE(!respond(law, {.dt = 1}, FinitePoints{F, old}, FiniteResults{piola, stored, dissipated, now}));
    REQUIRE(!tangents(law, {.dt = 1}, FinitePoints{F, old}, tangents_out));
    for (std::size_t i = 0; i < n; ++i) {
      MaterialPoint<FiniteLaw> point(law);
      const auto response = point.accept(unflat(&F[9 * i]));
      CHECK((unflat(&piola[9 * i]) - response.piola).norm() == 0);
      CHECK(stored[i] == response.stored);
      CHECK(dissipated[i] == response.dissipated);
      CHECK(std::equal(point.state().begin(), point.state().end(), now.begin() + i * states));
      MaterialPoint<FiniteLaw> virgin(law);
      CHECK((Eigen::Map<const PiolaTangent>(&tangents_out[81 * i]) - virgin.tangent(unflat(&F[9 * i]))).norm() == 0);
    }
    F[9 * 3] = std::nan("");
    const auto failure = respond(law, {.dt = 1}, FinitePoints{F, old}, FiniteResults{piola, stored, dissipated, now});
    REQUIRE(failure.has_value());
    CHECK(failure->point == 3);
    CHECK(failure->outcome == PointOutcome::NotFinite);
    CHECK(tangents(law, {.dt = 1}, FinitePoints{F, old}, tangents_out)->point == 3);
  }
}

TEST_CASE("plane batches are solid points with the components that are not stored zero") {
  RandomStrain random(63);
  std::vector<SmallLaw> laws{Elastic{100, 0.3}};
  for (const auto& [name, material] : sample_plastics())
    laws.push_back(SmallPlastic{material});
  for (const auto& law : laws) {
    const std::size_t states = state_names(law).size();
    constexpr std::size_t n = 3;
    std::vector<double> strain(4 * n), stress(4 * n), stored(n), dissipated(n), old(states * n), now(states * n),
        moduli(16 * n);
    for (auto& value : strain)
      value = random.between(-0.1, 0.1);
    REQUIRE(!respond<2>(law, {.dt = 1}, {strain, old}, {stress, stored, dissipated, now}));
    REQUIRE(!tangents<2>(law, {.dt = 1}, {strain, old}, moduli));
    for (std::size_t i = 0; i < n; ++i) {
      Strain<3> full = Strain<3>::Zero();
      for (int k = 0; k < 4; ++k)
        full[k] = strain[4 * i + k];
      MaterialPoint<SmallLaw> point(law);
      const Moduli<3> C = point.moduli(full);
      const auto response = point.accept(full);
      CHECK((Eigen::Map<const Stress<2>>(&stress[4 * i]) - response.stress.head<4>()).norm() == 0);
      CHECK(response.stress.tail<2>().norm() == 0);
      CHECK(stored[i] == response.stored);
      CHECK(std::equal(point.state().begin(), point.state().end(), now.begin() + i * states));
      CHECK((Eigen::Map<const Moduli<2>>(&moduli[16 * i]) - C.topLeftCorner<4, 4>()).norm() == 0);
      CHECK(C.topRightCorner<4, 2>().norm() == 0);
    }
  }
}
