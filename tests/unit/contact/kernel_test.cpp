// The contact law at a point, and the founding lecture's one-dimensional example solved with it.
#include "contact/kernel.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;

TEST_CASE("traction is never tensile, its derivative and potential are consistent") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-2.0, 2.0);
  int in_contact = 0;
  for (int i = 0; i < 1000; ++i) {
    const double lambda = number(random), gap = number(random), epsilon = 3.0, step = 1e-6;
    const double augmented = augmented_traction(lambda, epsilon, gap);
    if (std::abs(augmented) < 1e-4) continue; // the kink
    CHECK(normal_traction(augmented) <= 0.0);
    in_contact += augmented < 0.0;
    const auto sigma = [&](double g) { return normal_traction(augmented_traction(lambda, epsilon, g)); };
    CHECK((sigma(gap + step) - sigma(gap - step)) / (2 * step) ==
          doctest::Approx(epsilon * normal_traction_derivative(augmented)).epsilon(1e-6));
    const auto potential = [&](double g) {
      return contact_potential(augmented_traction(lambda, epsilon, g), lambda * lambda, epsilon);
    };
    CHECK((potential(gap + step) - potential(gap - step)) / (2 * step) == doctest::Approx(sigma(gap)).epsilon(1e-6));
  }
  CHECK(in_contact > 300); // both branches were seen
  CHECK(in_contact < 700);
}

// Minimize f(x) = x² + 2x + 1 under x >= 0: x = 0, λ = −2 (V. A. Yastrebov's lecture). The lecture's contact branch λ g
// + ε g² is ours with twice its ε.
namespace {

constexpr double lecture_epsilon = 10.0;

double minimizer_at(double lambda, double epsilon) { // of f + potential, contact branch: 2x + 2 + λ + ε x = 0
  return -(2.0 + lambda) / (2.0 + epsilon);
}

} // namespace

TEST_CASE("lecture example: penalty error is O(1/ε)") {
  for (const double epsilon : {1.0, 10.0, 50.0}) {
    const double x = minimizer_at(0.0, 2.0 * epsilon);
    CHECK(2.0 * x + 2.0 + normal_traction(augmented_traction(0.0, 2.0 * epsilon, x)) ==
          doctest::Approx(0.0).epsilon(1e-14));
    CHECK(x == doctest::Approx(-1.0 / (1.0 + epsilon)).epsilon(1e-12));
  }
}

TEST_CASE("lecture example: Uzawa's iterates and linear factor 1/(1+ε)") {
  const double expected_x[] = {-0.09090909, -0.00826446, -0.00075131, -0.00006830};
  const double expected_lambda[] = {-1.81818182, -1.98347107, -1.99849737, -1.99986340};
  double lambda = 0.0;
  for (int k = 0; k < 4; ++k) {
    const double x = minimizer_at(lambda, 2.0 * lecture_epsilon);
    lambda = normal_traction(augmented_traction(lambda, 2.0 * lecture_epsilon, x));
    CHECK(x == doctest::Approx(expected_x[k]).epsilon(1e-5));
    CHECK(lambda == doctest::Approx(expected_lambda[k]).epsilon(1e-8));
  }
}

TEST_CASE("lecture example: semismooth Newton on the saddle point takes at most two iterations from any start") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-10.0, 10.0);
  const double epsilon = 2.0 * lecture_epsilon;
  for (int i = 0; i < 200; ++i) {
    double x = number(random), lambda = number(random);
    int iterations = 0;
    for (; iterations < 3; ++iterations) {
      const double augmented = augmented_traction(lambda, epsilon, x);
      const double chi = normal_traction_derivative(augmented);
      const double force = 2.0 * x + 2.0 + normal_traction(augmented);
      const double constraint = (normal_traction(augmented) - lambda) / epsilon;
      if (std::hypot(force, constraint) < 1e-12) break;
      // [2 + χ ε, χ; χ, (χ − 1)/ε] δ = −(force, constraint)
      const double a = 2.0 + chi * epsilon, b = chi, c = (chi - 1.0) / epsilon, det = a * c - b * b;
      x -= (c * force - b * constraint) / det;
      lambda -= (a * constraint - b * force) / det;
    }
    CHECK(iterations <= 2);
    CHECK(x == doctest::Approx(0.0).epsilon(1e-12));
    CHECK(lambda == doctest::Approx(-2.0).epsilon(1e-12));
  }
}
