// The dual basis of a facet on its covered part.
#include "contact/dual_basis.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;

namespace {

const ElementType facets[] = {ElementType::Segment2,  ElementType::Segment3,       ElementType::Triangle3,
                              ElementType::Triangle6, ElementType::Quadrilateral4, ElementType::Quadrilateral9};

/// Control shape functions at the points of a rule.
PointTable control_values(ElementType type, const Quadrature& rule) {
  PointTable nodal(rule.size(), num_nodes(type));
  std::vector<double> values(num_nodes(type));
  for (int q = 0; q < rule.size(); ++q) {
    shape_values(type, rule.point(q), values);
    for (int a = 0; a < num_nodes(type); ++a)
      nodal(q, a) = values[a];
  }
  return nodal * nodes_from_controls(type);
}

} // namespace

TEST_CASE("control functions are not negative, sum to one and span what the nodal ones do") {
  for (const auto type : facets) {
    CAPTURE(int(type));
    const auto shape = control_values(type, quadrature(type, 9));
    CHECK(shape.minCoeff() >= -1e-15);
    CHECK((shape.rowwise().sum().array() - 1.0).abs().maxCoeff() < 1e-14);
    const auto n = num_nodes(type);
    CHECK((nodes_from_controls(type) * controls_from_nodes(type)).isApprox(Eigen::MatrixXd::Identity(n, n), 1e-13));
    const bool is_linear = element_order(type) == 1;
    CHECK(nodes_from_controls(type).isIdentity() == is_linear);
  }
}

TEST_CASE("dual functions are biorthogonal on whole and partly covered facets, and sum to one") {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  for (const auto type : facets)
    for (const double cover : {1.0, 0.7, 0.4}) {
      CAPTURE(int(type));
      CAPTURE(cover);
      const bool is_simplex = num_vertices(type) == 3;
      const auto& rule = quadrature(type, 12);
      const auto shape = control_values(type, rule);
      std::vector<double> weights;
      for (int q = 0; q < rule.size(); ++q) {
        const bool is_covered = rule.point(q)[0] <= (is_simplex ? cover : -1.0 + 2.0 * cover);
        weights.push_back(is_covered ? rule.weights[q] * (0.5 + number(generator)) : 0.0);
      }
      const auto dual = dual_basis(shape, weights);
      REQUIRE(dual.has_value());
      const Eigen::Map<const Eigen::VectorXd> w(weights.data(), rule.size());
      const Eigen::MatrixXd product = dual->values.transpose() * w.asDiagonal() * shape;
      const Eigen::VectorXd integral = shape.transpose() * w;
      CHECK((product - Eigen::MatrixXd(integral.asDiagonal())).norm() < 1e-11 * integral.norm());
      CHECK((dual->integral - integral).norm() < 1e-14 * integral.norm());
      CHECK(integral.minCoeff() > 0.0);
      CHECK((dual->values.rowwise().sum().array() - 1.0).abs().maxCoeff() < 1e-10);
    }
}

TEST_CASE("on a whole segment the dual functions are the known ones") {
  const auto& rule = quadrature(ElementType::Segment2, 5);
  const auto dual = dual_basis(control_values(ElementType::Segment2, rule), rule.weights);
  REQUIRE(dual.has_value());
  for (int q = 0; q < rule.size(); ++q) // (1 ∓ 3 ξ) / 2
    for (const int end : {0, 1})
      CHECK(dual->values(q, end) == doctest::Approx(0.5 * (1.0 + (end ? 3.0 : -3.0) * rule.point(q)[0])));
}

TEST_CASE("too little cover has no dual basis") {
  for (const auto type : facets) {
    CAPTURE(int(type));
    const auto& rule = quadrature(type, 9);
    const auto shape = control_values(type, rule);
    std::vector<double> weights(rule.size(), 0.0);
    CHECK_FALSE(dual_basis(shape, weights).has_value());
    weights[rule.size() / 2] = 1.0; // one point cannot tell the nodes apart
    CHECK_FALSE(dual_basis(shape, weights).has_value());
  }
}
