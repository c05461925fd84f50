// Functions of symmetric tensors against what defines them, most of all where eigenvalues coalesce.
#include "math/spectral.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>

using namespace amontons;
using doctest::Approx;

namespace {

Tensor rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

} // namespace

TEST_CASE("a spectrum rebuilds its tensor with orthonormal vectors, also from values that nearly coalesce") {
  std::mt19937 random(1);
  for (const double gap : {0.0, 1e-16, 1e-12, 1e-8, 1e-4, 1.0})
    for (int i = 0; i < 50; ++i) {
      const Tensor Q = rotation(random);
      const Eigen::Vector3d wanted(1, 1 + gap, 1 + (i % 2) * 2 * gap);
      const Tensor A = Q * wanted.asDiagonal() * Q.transpose();
      const auto [values, vectors] = spectrum(A);
      CHECK((vectors * values.asDiagonal() * vectors.transpose() - A).norm() < 1e-14);
      CHECK((vectors.transpose() * vectors - Tensor::Identity()).norm() < 1e-14);
      CHECK(values[0] == Approx(1).epsilon(1e-14));
      CHECK(values[2] == Approx(wanted.maxCoeff()).epsilon(1e-14));
    }
  CHECK(std::isnan(spectrum(Tensor::Constant(std::numeric_limits<double>::infinity())).values[0]));
}

TEST_CASE("the exponential is its series, and turns with its argument") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (int i = 0; i < 50; ++i) {
    const Tensor half = Tensor::NullaryExpr([&] { return uniform(random); }), A = half + half.transpose();
    Tensor series = Tensor::Identity(), term = Tensor::Identity();
    for (int k = 1; k < 40; ++k)
      series += term = term * A / k;
    CHECK((exp_symmetric(A) - series).norm() < 1e-13 * series.norm());
    CHECK(exp_symmetric(A).determinant() == Approx(std::exp(A.trace())).epsilon(1e-13));
  }
}

TEST_CASE("the quotient of logarithms has all its digits for any distance of its arguments") {
  CHECK(log_quotient(2, 2) == 0.5);
  CHECK(log_quotient(std::exp(1.0), 1) == Approx(1 / (std::exp(1.0) - 1)).epsilon(1e-15));
  for (const double b : {1e-3, 1.0, 1e3})
    for (double r = 1e-16; r < 0.1; r *= 3) {
      const double a = b * (1 + r), x = (a - b) / b;
      const double series = 1 - x / 2 + x * x / 3 - x * x * x / 4 + x * x * x * x / 5 - std::pow(x, 5) / 6;
      CHECK(log_quotient(a, b) * b == Approx(series).epsilon(1e-15 + std::pow(x, 6)));
      CHECK(log_quotient(b, a) == Approx(log_quotient(a, b)).epsilon(1e-14));
    }
}

TEST_CASE("six components and tensors: engineering shears of strains, and the work of both") {
  const Strain<3> strain{1, 2, 3, 4, 5, 6};
  const Tensor E = strain_tensor(strain);
  CHECK(E(0, 1) == 2);
  CHECK(E(1, 2) == 2.5);
  CHECK(E(2, 0) == 3);
  CHECK((E - E.transpose()).norm() == 0);
  CHECK((strain_vector(E) - strain).norm() == 0);
  Tensor S;
  S << 7, 1, 2, 1, 8, 3, 2, 3, 9;
  CHECK(stress_vector(S).dot(strain) == contract(S, E));
  CHECK(deviator(S).trace() == Approx(0));
  CHECK(deviator(S)(0, 1) == 1);
}
