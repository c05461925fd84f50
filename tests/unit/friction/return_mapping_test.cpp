// Return mapping: cone, complementarity, dissipation on random paths; derivatives; invariance; Coulomb's closed form.
#include "friction/return_mapping.hpp"
#include "samples.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

namespace {

Eigen::Vector3d eigen(const TangentVector& v) { return {v[0], v[1], v[2]}; }
Eigen::Matrix3d eigen(const TangentMatrix& m) {
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i)
    result.row(i) = eigen(m[i]).transpose();
  return result;
}
TangentVector plain(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// Everything that must hold at one increment of any law.
void check_conditions(const FrictionResponse& response, const TangentVector& q, double epsilon) {
  const double r = eigen(q).norm(), size = eigen(response.traction).norm();
  const double scale = 1e-12 * (r + response.tau_c);
  CHECK(size <= response.tau_c + scale); // cone
  CHECK(response.slip >= 0);
  CHECK(response.slip * (response.tau_c - size) <= scale * response.slip); // complementarity
  CHECK(std::abs(r - epsilon * response.slip - size) <= scale);            // what is not slip is carried
  CHECK(eigen(response.traction).dot(eigen(q)) >= (1 - 1e-12) * size * r); // along the trial traction
  CHECK(response.tau_c * response.slip >= 0);                              // dissipation
  CHECK((response.status == FrictionStatus::Slip) == (response.slip > 0));
  CHECK(eigen(response.dtraction_dq).allFinite());
  CHECK(eigen(response.dtraction_dp).allFinite());
  CHECK(std::isfinite(response.state[0]));
}

} // namespace

TEST_CASE("10,000 random paths of every law: cone, complementarity and dissipation in every increment") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(21);
    int stick = 0, slip = 0;
    for (int path = 0; path < 10000; ++path) {
      const int dim = path % 2 == 0 ? 2 : 3;
      const double epsilon = std::exp(random.between(-2, 5));
      TangentVector traction{};
      FrictionState state{};
      bool was_open = true;
      double dissipated = 0;
      for (int increment = 0; increment < 6; ++increment) {
        if (random.with_chance(0.1)) { // opens: the traction is lost
          was_open = true;
          traction = {};
          continue;
        }
        auto context = random.context();
        context.new_contact = was_open;
        const double p = random.with_chance(0.05) ? 0.0 : random.between(0, 5);
        const double reach = std::exp(random.between(-3, 2)); // traction that the increment would add
        auto q = random.vector(dim, reach);
        for (int i = 0; i < 3; ++i)
          q[i] += traction[i];
        const auto response = return_map(law, context, q, p, epsilon, state);
        check_conditions(response, q, epsilon);
        dissipated += response.tau_c * response.slip;
        (response.slip > 0 ? slip : stick) += 1;
        traction = response.traction;
        state = response.state;
        was_open = false;
      }
      CHECK(dissipated >= 0);
    }
    CHECK(slip > 5000);
    CHECK((stick > 5000) == (name.find("rate_and_state") == std::string::npos ||
                             name.find("cohesion") != std::string::npos)); // else it creeps
  }
}

TEST_CASE("coulomb: the closed radial return and its derivatives") {
  RandomPoint random(22);
  int slip = 0;
  for (int i = 0; i < 2000; ++i) {
    const double mu = random.between(0, 1), p = random.between(0, 3), epsilon = random.between(0.1, 100);
    const auto q = random.vector(3, 2);
    const Eigen::Vector3d trial = eigen(q);
    const auto response = return_map(Coulomb{.mu = mu}, {}, q, p, epsilon, {});
    const double r = trial.norm();
    if (r <= mu * p) {
      CHECK(response.status == FrictionStatus::Stick);
      CHECK(eigen(response.traction) == trial);
      CHECK(eigen(response.dtraction_dq) == Eigen::Matrix3d::Identity());
      CHECK(eigen(response.dtraction_dp).norm() == 0);
      continue;
    }
    ++slip;
    const Eigen::Vector3d n = trial / r;
    CHECK(response.status == FrictionStatus::Slip);
    CHECK((eigen(response.traction) - mu * p * n).norm() < 1e-14 * r);
    CHECK(response.slip == doctest::Approx((r - mu * p) / epsilon).epsilon(1e-12));
    const Eigen::Matrix3d across = mu * p / r * (Eigen::Matrix3d::Identity() - n * n.transpose());
    CHECK((eigen(response.dtraction_dq) - across).norm() < 1e-14);
    CHECK((eigen(response.dtraction_dp) - mu * n).norm() < 1e-14);
  }
  CHECK(slip > 500);
  CHECK(slip < 1900);
}

TEST_CASE("derivatives against central differences, every law, 2D and 3D, both sides of the border") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(23);
    int stick = 0, slip = 0, coupled = 0, curved = 0;
    for (int i = 0; i < 1500; ++i) {
      const int dim = i % 2 == 0 ? 2 : 3;
      auto context = random.context();
      context.new_contact = random.with_chance(0.2);
      const auto state = random.state(law);
      const double p = random.between(0.3, 4), epsilon = random.between(3, 30), h = 1e-6;
      const auto q = random.vector(dim, random.with_chance(0.3) ? 0.6 : 3);
      const auto at = [&](const Eigen::Vector3d& trial, double pressure) {
        return return_map(law, context, plain(trial), pressure, epsilon, state);
      };
      const auto response = at(eigen(q), p);
      if (response.is_several) continue;
      bool is_smooth = true; // the points of the difference lie on one side of every border
      const auto difference = [&](const Eigen::Vector3d& dq, double dp) -> Eigen::Vector3d {
        const auto plus = at(eigen(q) + h * dq, p + h * dp), minus = at(eigen(q) - h * dq, p - h * dp);
        const Eigen::Vector3d second = eigen(plus.traction) - 2 * eigen(response.traction) + eigen(minus.traction);
        is_smooth = is_smooth && plus.status == minus.status && second.norm() < 1e-3 * h;
        return (eigen(plus.traction) - eigen(minus.traction)) / (2 * h);
      };
      Eigen::Matrix3d dq;
      for (int j = 0; j < 3; ++j)
        dq.col(j) = difference(Eigen::Vector3d::Unit(j), 0);
      const Eigen::Vector3d dp = difference(Eigen::Vector3d::Zero(), 1);
      if (!is_smooth) continue;
      CHECK((eigen(response.dtraction_dq) - dq).norm() < 1e-7 * dq.norm());
      CHECK((eigen(response.dtraction_dp) - dp).norm() < 1e-7 * (dq.norm() + dp.norm()));
      REQUIRE(dq.norm() > 1e-2);
      (response.status == FrictionStatus::Slip ? slip : stick) += 1;
      coupled += dp.norm() > 1e-4;
      curved += (dq - Eigen::Matrix3d::Identity()).norm() > 1e-2;
    }
    CHECK(slip > 200);
    CHECK(curved > 200);
    CHECK((coupled > 200) == (name != "tresca"));
    const bool creeps = std::holds_alternative<RateAndState>(law) && name.find("cohesion") == std::string::npos;
    if (!creeps) CHECK(stick > 50);
  }
}

TEST_CASE("Taylor: the traction's remainder in a random direction of (q, p) is of second order") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(24);
    int seen = 0;
    for (int i = 0; i < 200 && seen < 20; ++i) {
      const FrictionContext context{.dt = random.between(0.2, 1)};
      const auto state = random.state(law);
      const double p = random.between(0.5, 1), epsilon = 20, dp = random.between(-1, 1);
      const Eigen::Vector3d q = eigen(random.vector(3, 1)).normalized() * 4, dq = eigen(random.vector(3, 1));
      const auto response = return_map(law, context, plain(q), p, epsilon, state);
      if (response.is_several || response.status == FrictionStatus::Stick) continue;
      const auto remainder = [&](double h) {
        const auto there = return_map(law, context, plain(q + h * dq), p + h * dp, epsilon, state);
        return (eigen(there.traction) - eigen(response.traction) -
                h * (eigen(response.dtraction_dq) * dq + eigen(response.dtraction_dp) * dp))
            .norm();
      };
      const double coarse = remainder(2e-3), fine = remainder(1e-3);
      REQUIRE(coarse > 1e-9);
      CHECK(coarse / fine == doctest::Approx(4).epsilon(0.05));
      ++seen;
    }
    CHECK(seen == 20);
  }
}

TEST_CASE("rotating the trial traction rotates the answer; sizes do not notice") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(25);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Matrix3d R =
          Eigen::AngleAxisd(random.between(-3, 3), eigen(random.vector(3, 1)).normalized()).toRotationMatrix();
      const auto context = random.context();
      const auto state = random.state(law);
      const double p = random.between(0, 5), epsilon = random.between(1, 30);
      const auto q = random.vector(3, 3);
      const auto here = return_map(law, context, q, p, epsilon, state);
      const auto there = return_map(law, context, plain(R * eigen(q)), p, epsilon, state);
      CHECK((eigen(there.traction) - R * eigen(here.traction)).norm() < 1e-12 * (1 + here.tau_c));
      CHECK((eigen(there.dtraction_dq) - R * eigen(here.dtraction_dq) * R.transpose()).norm() < 1e-10);
      CHECK((eigen(there.dtraction_dp) - R * eigen(here.dtraction_dp)).norm() < 1e-10);
      CHECK(there.slip == doctest::Approx(here.slip).epsilon(1e-10));
    }
  }
}

TEST_CASE("units: stresses times 1e6 and lengths times 1e-3 change nothing else") {
  RandomPoint random(26);
  const RateAndState mm{.mu = 0.6, .a = 0.015, .b = 0.02, .L = 0.5, .v0 = 0.3};
  RateAndState m = mm;
  m.L *= 1e-3;
  m.v0 *= 1e-3;
  for (int i = 0; i < 500; ++i) {
    const auto context = random.context();
    const double p = random.between(0.1, 5), epsilon = random.between(0.02, 30);
    auto q = random.vector(2, 3);
    const auto first = return_map(mm, context, q, p, epsilon, {0.3, 0});
    for (auto& component : q)
      component *= 1e6;
    const auto second = return_map(m, context, q, p * 1e6, epsilon * 1e9, {0.3, 0});
    CHECK(second.tau_c == doctest::Approx(1e6 * first.tau_c).epsilon(1e-10));
    CHECK(second.slip == doctest::Approx(1e-3 * first.slip).epsilon(1e-9));
    CHECK(second.is_several == first.is_several);
  }
}

TEST_CASE("no pressure, no coefficient, no trial traction: defined, and zero where the limit is zero") {
  const TangentVector zero{}, some{0.3, -0.4, 0};
  for (const double p : {0.0, 2.0})
    for (const auto& q : {zero, some}) {
      const auto response = return_map(Coulomb{.mu = p > 0 ? 0.0 : 0.5}, {}, q, p, 10, {});
      CHECK(eigen(response.traction).norm() == 0);
      CHECK(eigen(response.dtraction_dq).norm() == 0);
      CHECK(response.slip == doctest::Approx(eigen(q).norm() / 10));
    }
  // The contact that is about to carry: derivative with respect to pressure from the side of p > 0.
  const auto touching = return_map(Coulomb{.mu = 0.5}, {}, some, 0, 10, {});
  CHECK((eigen(touching.dtraction_dp) - 0.5 * eigen(some) / 0.5).norm() < 1e-14);
  for (const auto& [name, law] : sample_laws())
    for (const double p : {0.0, 2.0})
      for (const double dt : {0.0, 1.0}) {
        CAPTURE(name);
        const FrictionContext begins{.dt = dt, .new_contact = true};
        check_conditions(return_map(law, begins, zero, p, 10, {}), zero, 10);
        check_conditions(return_map(law, begins, some, p, 10, {}), some, 10);
      }
}

TEST_CASE("a rate-and-state contact at rest: the derivative of creep, which is nearly that of stick") {
  const FrictionLaw law = RateAndState{.mu = 0.6, .a = 0.015, .b = 0.02, .L = 0.5, .v0 = 0.3};
  const FrictionContext context{.dt = 1};
  const auto rest = return_map(law, context, {}, 2, 10, {});
  CHECK(rest.slip == 0);
  CHECK((eigen(rest.dtraction_dq) - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  const auto creep = return_map(law, context, {0.1, 0, 0}, 2, 10, {});
  CHECK(creep.slip > 0);
  CHECK(creep.slip < 1e-12);
  CHECK(creep.traction[0] == doctest::Approx(0.1).epsilon(1e-10));
}

TEST_CASE("a guessed response is that of sliding on, or of sticking") {
  const Coulomb law{.mu = 0.4};
  const FrictionContext context{.dt = 0.1, .factor = 1.0, .new_contact = false};
  const double p = 2.0, epsilon = 50.0, slip = 0.01;
  const TangentVector at_limit{0.4 * p * 0.6, 0.4 * p * 0.8, 0.0};
  const auto sliding = guess_response(law, context, at_limit, p, epsilon, {}, slip);
  CHECK(sliding.slip == doctest::Approx(slip));
  CHECK((eigen(sliding.traction) - eigen(at_limit)).norm() < 1e-14);
  // A radial change of q only makes it slide farther; the limit follows the pressure.
  CHECK((eigen(sliding.dtraction_dq) * eigen(at_limit)).norm() < 1e-14);
  CHECK((eigen(sliding.dtraction_dp) - eigen(at_limit) / p).norm() < 1e-14);

  const auto sticking = guess_response(law, context, at_limit, p, epsilon, {}, 0.0);
  CHECK(sticking.traction == at_limit);
  CHECK((eigen(sticking.dtraction_dq) - Eigen::Matrix3d::Identity()).norm() == 0.0);
  CHECK(eigen(sticking.dtraction_dp).norm() == 0.0);
}
