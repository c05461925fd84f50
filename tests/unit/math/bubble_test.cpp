// The cell bubble against its defining properties, and what a quadrature rule sees of it.
#include "math/bubble.hpp"
#include "math/reference_element.hpp"

#include <array>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

namespace {

constexpr ElementType cells[] = {ElementType::Triangle6, ElementType::Tetrahedron10};

/// ∫ over the reference cell of f(ξ), exact for polynomials up to degree 8.
template <class Function>
double integral(ElementType type, Function&& f) {
  const Quadrature& rule = quadrature(type, 8);
  double sum = 0;
  for (int q = 0; q < rule.size(); ++q)
    sum += rule.weights[q] * f(rule.point(q));
  return sum;
}

double slope(ElementType type, std::span<const double> xi, int i) {
  std::array<double, 3> gradient{};
  bubble_gradient(type, xi, std::span(gradient).first(xi.size()));
  return gradient[i];
}

} // namespace

TEST_CASE("the bubble is one at the centroid and zero on the boundary") {
  for (const ElementType type : cells) {
    const int dim = element_dim(type);
    const std::vector<double> centroid(dim, 1.0 / (dim + 1));
    CHECK(bubble_value(type, centroid) == doctest::Approx(1).epsilon(1e-14));
    std::vector<double> on_slope(dim, 0.8 / dim);
    on_slope[0] += 0.2; // Σ ξ_i = 1
    CHECK(std::abs(bubble_value(type, on_slope)) < 1e-14);
    for (int i = 0; i < dim; ++i) {
      std::vector<double> side(dim, 0.2);
      side[i] = 0;
      CHECK(bubble_value(type, side) == 0);
    }
  }
}

TEST_CASE("the gradient of the bubble is that of finite differences") {
  const double all[] = {0.17, 0.31, 0.23}, h = 1e-5;
  for (const ElementType type : cells)
    for (int i = 0; i < element_dim(type); ++i) {
      std::vector<double> after(all, all + element_dim(type)), before = after;
      after[i] += h;
      before[i] -= h;
      const double difference = (bubble_value(type, after) - bubble_value(type, before)) / (2 * h);
      REQUIRE(std::abs(difference) > 1e-2);
      CHECK(slope(type, {all, before.size()}, i) == doctest::Approx(difference).epsilon(1e-7));
    }
}

TEST_CASE("a rule of degree 2 feels all that linear functions have of the bubble, and knows what it does not see") {
  for (const ElementType type : cells) {
    CAPTURE(int(type));
    const int dim = element_dim(type);
    const Quadrature& rule = quadrature(type, 2);
    const BubbleTable& table = bubble_table(type, 2);
    const double volume = integral(type, [](auto) { return 1.0; });
    REQUIRE(table.unseen[0] > 0.1);
    for (int i = 0; i < dim; ++i) {
      for (int p = -1; p < dim; ++p) { // against 1 and the coordinates
        double sum = 0;
        for (int q = 0; q < rule.size(); ++q)
          sum += rule.weights[q] * table.gradient(q)[i] * (p < 0 ? 1.0 : rule.point(q)[p]);
        const double exact = integral(type, [&](auto xi) { return slope(type, xi, i) * (p < 0 ? 1.0 : xi[p]); });
        CHECK(sum == doctest::Approx(exact).epsilon(1e-12));
      }
      for (int j = 0; j < dim; ++j) {
        double seen = 0;
        for (int q = 0; q < rule.size(); ++q)
          seen += rule.weights[q] * table.gradient(q)[i] * table.gradient(q)[j];
        const double exact = integral(type, [&](auto xi) { return slope(type, xi, i) * slope(type, xi, j); });
        CHECK(seen + volume * table.unseen[i * dim + j] == doctest::Approx(exact).epsilon(1e-12));
      }
    }
    for (int q = 0; q < rule.size(); ++q)
      CHECK(table.values[q] == bubble_value(type, rule.point(q)));
  }
}

TEST_CASE("a rule of degree 4 sees all of a triangle's bubble") {
  const BubbleTable& table = bubble_table(ElementType::Triangle6, 4);
  const Quadrature& rule = quadrature(ElementType::Triangle6, 4);
  for (const double left : table.unseen)
    CHECK(std::abs(left) < 1e-12);
  for (int q = 0; q < rule.size(); ++q)
    for (int i = 0; i < 2; ++i)
      CHECK(table.gradient(q)[i] == doctest::Approx(slope(ElementType::Triangle6, rule.point(q), i)).epsilon(1e-11));
}
