#include "math/bubble.hpp"

#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

namespace amontons {
namespace {

/// Barycentric coordinates, L_0 = 1 - Σ ξ_i first.
std::array<double, 4> barycentric(std::span<const double> xi) {
  std::array<double, 4> l = {1, 0, 0, 0};
  for (std::size_t i = 0; i < xi.size(); ++i) {
    l[i + 1] = xi[i];
    l[0] -= xi[i];
  }
  return l;
}

/// Makes b one at the centroid.
double height(std::size_t dim) { return dim == 2 ? 27 : 256; }

/// All monomials of the reference coordinates up to a degree.
Eigen::VectorXd monomials(std::span<const double> xi, int degree) {
  std::vector<double> values;
  const double z = xi.size() == 3 ? xi[2] : 0.0;
  const int highest_z = xi.size() == 3 ? degree : 0;
  for (int k = 0; k <= highest_z; ++k)
    for (int j = 0; j + k <= degree; ++j)
      for (int i = 0; i + j + k <= degree; ++i)
        values.push_back(std::pow(xi[0], i) * std::pow(xi[1], j) * std::pow(z, k));
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

BubbleTable make_table(ElementType type, int degree) {
  const int dim = element_dim(type), order = degree / 2;
  // Π ∇b = Σ_p c_p m_p with Σ_p ∫ m_r m_p c_p = ∫ m_r ∇b; the bubble's gradient has degree dim.
  const Quadrature& exact = quadrature(type, 2 * std::max(dim, order));
  const auto size = monomials(exact.point(0), order).size();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(size, size), right = Eigen::MatrixXd::Zero(size, dim);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(dim, dim);
  Eigen::VectorXd slope(dim);
  double volume = 0;
  for (int q = 0; q < exact.size(); ++q) {
    const Eigen::VectorXd m = monomials(exact.point(q), order);
    bubble_gradient(type, exact.point(q), {slope.data(), static_cast<std::size_t>(dim)});
    volume += exact.weights[q];
    mass += exact.weights[q] * m * m.transpose();
    right += exact.weights[q] * m * slope.transpose();
    square += exact.weights[q] * slope * slope.transpose();
  }
  const Eigen::MatrixXd factors = mass.llt().solve(right);
  const Eigen::MatrixXd unseen = (square - factors.transpose() * right) / volume;

  const Quadrature& rule = quadrature(type, degree);
  BubbleTable table{dim, {}, {}, {unseen.data(), unseen.data() + unseen.size()}};
  for (int q = 0; q < rule.size(); ++q) {
    const Eigen::VectorXd gradient = factors.transpose() * monomials(rule.point(q), order);
    table.values.push_back(bubble_value(type, rule.point(q)));
    table.gradients.insert(table.gradients.end(), gradient.begin(), gradient.end());
  }
  return table;
}

} // namespace

double bubble_value(ElementType type, std::span<const double> xi) {
  const auto l = barycentric(xi);
  return std::accumulate(l.begin(), l.begin() + element_dim(type) + 1, height(xi.size()), std::multiplies<>());
}

void bubble_gradient(ElementType type, std::span<const double> xi, std::span<double> gradient) {
  const auto l = barycentric(xi);
  const int dim = element_dim(type);
  const auto product_without = [&](int left_out) {
    double product = height(xi.size());
    for (int p = 0; p <= dim; ++p)
      if (p != left_out) product *= l[p];
    return product;
  };
  for (int i = 0; i < dim; ++i)
    gradient[i] = product_without(i + 1) - product_without(0);
}

const BubbleTable& bubble_table(ElementType type, int degree) {
  static std::map<std::pair<ElementType, int>, BubbleTable> tables;
  const auto found = tables.find({type, degree});
  if (found != tables.end()) return found->second;
  return tables.emplace(std::pair(type, degree), make_table(type, degree)).first->second;
}

} // namespace amontons
