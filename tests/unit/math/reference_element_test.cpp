// Shape functions against their defining properties and finite differences, quadrature against exact integrals.
#include "math/reference_element.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

namespace {

constexpr ElementType all_types[] = {
    ElementType::Segment2,       ElementType::Segment3,       ElementType::Triangle3,    ElementType::Triangle6,
    ElementType::Quadrilateral4, ElementType::Quadrilateral9, ElementType::Tetrahedron4, ElementType::Tetrahedron10,
    ElementType::Hexahedron8,    ElementType::Hexahedron27};

bool is_simplex(ElementType type) {
  const ElementType linear = linear_element(type);
  return linear == ElementType::Triangle3 || linear == ElementType::Tetrahedron4;
}

/// A point inside every reference cell, without symmetry.
std::vector<double> inner_point(int dim) {
  const std::vector<double> all = {0.17, 0.31, 0.23};
  return {all.begin(), all.begin() + dim};
}

std::vector<double> values_at(ElementType type, std::span<const double> xi) {
  std::vector<double> values(num_nodes(type));
  shape_values(type, xi, values);
  return values;
}

std::vector<double> gradients_at(ElementType type, std::span<const double> xi) {
  std::vector<double> gradients(std::size_t(num_nodes(type)) * element_dim(type));
  shape_gradients(type, xi, gradients);
  return gradients;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

/// ∫ Π x_i^p_i: p!q!r!/(p+q+r+d)! on the unit simplex, products of 2/(p+1) or zero on [-1, 1]^d.
double exact_integral(ElementType type, const int* powers) {
  const int dim = element_dim(type);
  if (is_simplex(type)) {
    double above = 1;
    int sum = dim;
    for (int i = 0; i < dim; ++i) {
      above *= factorial(powers[i]);
      sum += powers[i];
    }
    return above / factorial(sum);
  }
  double result = 1;
  for (int i = 0; i < dim; ++i)
    result *= powers[i] % 2 ? 0.0 : 2.0 / (powers[i] + 1);
  return result;
}

double quadrature_integral(const Quadrature& rule, const int* powers) {
  double sum = 0;
  for (int q = 0; q < rule.size(); ++q) {
    double product = rule.weights[q];
    for (int i = 0; i < rule.dim; ++i)
      product *= std::pow(rule.point(q)[i], powers[i]);
    sum += product;
  }
  return sum;
}

} // namespace

TEST_CASE("shape functions are one at their node and zero at the others") {
  for (const ElementType type : all_types) {
    CAPTURE(int(type));
    const int dim = element_dim(type);
    const auto nodes = reference_nodes(type);
    REQUIRE(int(nodes.size()) == dim * num_nodes(type));
    for (int b = 0; b < num_nodes(type); ++b) {
      const auto values = values_at(type, nodes.subspan(b * dim, dim));
      for (int a = 0; a < num_nodes(type); ++a)
        CHECK(values[a] == doctest::Approx(a == b ? 1.0 : 0.0).epsilon(1e-14));
    }
  }
}

TEST_CASE("shape functions reproduce every polynomial of their order") {
  for (const ElementType type : all_types) {
    CAPTURE(int(type));
    const int dim = element_dim(type), order = element_order(type);
    const auto nodes = reference_nodes(type);
    const auto xi = inner_point(dim);
    const auto values = values_at(type, xi);
    for (int p = 0; p <= order; ++p)
      for (int q = 0; q <= (dim > 1 ? order - p : 0); ++q)
        for (int r = 0; r <= (dim > 2 ? order - p - q : 0); ++r) {
          const int powers[] = {p, q, r};
          const auto monomial = [&](std::span<const double> x) {
            double result = 1;
            for (int i = 0; i < dim; ++i)
              result *= std::pow(x[i], powers[i]);
            return result;
          };
          double sum = 0;
          for (int a = 0; a < num_nodes(type); ++a)
            sum += values[a] * monomial(nodes.subspan(a * dim, dim));
          CHECK(sum == doctest::Approx(monomial(xi)).epsilon(1e-13));
        }
  }
}

TEST_CASE("gradients and hessians are derivatives of the values") {
  const double h = 1e-5;
  for (const ElementType type : all_types) {
    CAPTURE(int(type));
    const int dim = element_dim(type), n = num_nodes(type);
    const auto xi = inner_point(dim);
    const auto gradients = gradients_at(type, xi);
    std::vector<double> hessians(std::size_t(n) * dim * dim);
    shape_hessians(type, xi, hessians);
    double largest = 0;
    for (int i = 0; i < dim; ++i) {
      auto plus = xi, minus = xi;
      plus[i] += h;
      minus[i] -= h;
      const auto values_plus = values_at(type, plus), values_minus = values_at(type, minus);
      const auto gradients_plus = gradients_at(type, plus), gradients_minus = gradients_at(type, minus);
      for (int a = 0; a < n; ++a) {
        CHECK(std::abs(gradients[a * dim + i] - (values_plus[a] - values_minus[a]) / (2 * h)) < 1e-9);
        largest = std::max(largest, std::abs(gradients[a * dim + i]));
        for (int j = 0; j < dim; ++j)
          CHECK(std::abs(hessians[(a * dim + j) * dim + i] -
                         (gradients_plus[a * dim + j] - gradients_minus[a * dim + j]) / (2 * h)) < 1e-9);
      }
    }
    CHECK(largest > 0.1);
  }
}

TEST_CASE("quadrature integrates every monomial of its degree exactly, with positive weights inside the cell") {
  for (const ElementType type : all_types) {
    if (element_order(type) == 2) continue; // the same rules
    const int dim = element_dim(type);
    for (int degree = 0; degree <= 12; ++degree) {
      CAPTURE(int(type));
      CAPTURE(degree);
      const Quadrature& rule = quadrature(type, degree);
      const int constant[] = {0, 0, 0};
      const double volume = exact_integral(type, constant);
      for (int p = 0; p <= degree; ++p)
        for (int q = 0; q <= (dim > 1 ? degree : 0); ++q)
          for (int r = 0; r <= (dim > 2 ? degree : 0); ++r) {
            const int powers[] = {p, q, r};
            if (is_simplex(type) && p + q + r > degree) continue;
            CHECK(std::abs(quadrature_integral(rule, powers) - exact_integral(type, powers)) < 1e-14 * volume);
          }
      for (int q = 0; q < rule.size(); ++q) {
        CHECK(rule.weights[q] > 0);
        double sum = 0;
        for (const double x : rule.point(q)) {
          CHECK(x > (is_simplex(type) ? 0 : -1));
          CHECK(x < 1);
          sum += x;
        }
        if (is_simplex(type)) CHECK(sum < 1);
      }
    }
  }
}

TEST_CASE("a rule is not exact two degrees above its own") {
  for (const ElementType type : {ElementType::Segment2, ElementType::Triangle3, ElementType::Tetrahedron4}) {
    const int powers[] = {4, 0, 0};
    CHECK(std::abs(quadrature_integral(quadrature(type, 2), powers) - exact_integral(type, powers)) > 1e-4);
  }
}

TEST_CASE("a tabulation holds values and gradients at the points of its rule") {
  for (const ElementType type : all_types) {
    const Tabulation& table = tabulation(type, 3);
    REQUIRE(table.rule == &quadrature(type, 3));
    CHECK(&table == &tabulation(type, 3));
    for (int q = 0; q < table.rule->size(); ++q) {
      const auto xi = table.rule->point(q);
      const auto values = values_at(type, xi), gradients = gradients_at(type, xi);
      CHECK(std::equal(values.begin(), values.end(), table.value(q).begin(), table.value(q).end()));
      CHECK(std::equal(gradients.begin(), gradients.end(), table.gradient(q).begin(), table.gradient(q).end()));
    }
  }
}
