#include "math/reference_element.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace amontons {
namespace {

// --- node positions, gmsh's order ------------------------------------------------------------------------------------

constexpr double segment_nodes[] = {-1, 1, 0};

// clang-format off
constexpr double quadrilateral_nodes[] = {
    -1, -1,  1, -1,  1, 1,  -1, 1,   // corners
     0, -1,  1,  0,  0, 1,  -1, 0,   // middles of the edges 01 12 23 30
     0,  0};

constexpr double hexahedron_nodes[] = {
    -1, -1, -1,   1, -1, -1,   1,  1, -1,  -1,  1, -1,   // corners
    -1, -1,  1,   1, -1,  1,   1,  1,  1,  -1,  1,  1,
     0, -1, -1,  -1,  0, -1,  -1, -1,  0,   1,  0, -1,   // middles of the edges 01 03 04 12
     1, -1,  0,   0,  1, -1,   1,  1,  0,  -1,  1,  0,   //                      15 23 26 37
     0, -1,  1,  -1,  0,  1,   1,  0,  1,   0,  1,  1,   //                      45 47 56 67
     0,  0, -1,   0, -1,  0,  -1,  0,  0,                // middles of the faces z- y- x-
     1,  0,  0,   0,  1,  0,   0,  0,  1,                //                      x+ y+ z+
     0,  0,  0};

constexpr double triangle_nodes[] = {
    0, 0,  1, 0,  0, 1,
    0.5, 0,  0.5, 0.5,  0, 0.5};

constexpr double tetrahedron_nodes[] = {
    0, 0, 0,   1, 0, 0,   0, 1, 0,   0, 0, 1,
    0.5, 0, 0,   0.5, 0.5, 0,   0, 0.5, 0,
    0, 0, 0.5,   0, 0.5, 0.5,   0.5, 0, 0.5};

// Ends of the edges on whose middles the nodes behind the corners lie.
constexpr int triangle_edges[][2] = {{0, 1}, {1, 2}, {0, 2}};
constexpr int tetrahedron_edges[][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
// clang-format on

// --- products of one-dimensional Lagrange polynomials ----------------------------------------------------------------

/// Value, first and second derivative of a polynomial of one variable.
using Jet = std::array<double, 3>;

/// The Lagrange polynomials of the nodes -1, 0, 1 (in this order) at x; with order 1 those of -1 and 1.
template <int order>
std::array<Jet, 3> lagrange(double x) {
  if constexpr (order == 1)
    return {Jet{0.5 * (1 - x), -0.5, 0}, Jet{}, Jet{0.5 * (1 + x), 0.5, 0}};
  else
    return {Jet{0.5 * x * (x - 1), x - 0.5, 1}, Jet{1 - x * x, -2 * x, -2}, Jet{0.5 * x * (x + 1), x + 0.5, 1}};
}

template <int dim, int order, int nodes>
struct TensorElement {
  /// Calls visit(a, jets) for each node, jets[i] the polynomial of coordinate i whose product over i is N_a.
  template <class Visit>
  static void each_node(const double* xi, const double* positions, Visit&& visit) {
    std::array<std::array<Jet, 3>, dim> table;
    for (int i = 0; i < dim; ++i)
      table[i] = lagrange<order>(xi[i]);
    std::array<Jet, dim> jets;
    for (int a = 0; a < nodes; ++a) {
      for (int i = 0; i < dim; ++i)
        jets[i] = table[i][static_cast<std::size_t>(positions[a * dim + i] + 1)];
      visit(a, jets);
    }
  }

  /// Π_i of the derivative of order orders[i].
  static double product(const std::array<Jet, dim>& jets, const std::array<int, dim>& orders) {
    double result = 1;
    for (int i = 0; i < dim; ++i)
      result *= jets[i][orders[i]];
    return result;
  }

  static void values(const double* xi, const double* positions, double* out) {
    each_node(xi, positions, [&](int a, const auto& jets) { out[a] = product(jets, {}); });
  }
  static void gradients(const double* xi, const double* positions, double* out) {
    each_node(xi, positions, [&](int a, const auto& jets) {
      for (int i = 0; i < dim; ++i) {
        std::array<int, dim> orders{};
        orders[i] = 1;
        out[a * dim + i] = product(jets, orders);
      }
    });
  }
  static void hessians(const double* xi, const double* positions, double* out) {
    each_node(xi, positions, [&](int a, const auto& jets) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) {
          std::array<int, dim> orders{};
          ++orders[i];
          ++orders[j];
          out[(a * dim + i) * dim + j] = product(jets, orders);
        }
    });
  }
};

// --- simplices: polynomials of the barycentric coordinates L_0 = 1 - Σ ξ_i, L_i = ξ_{i-1} ----------------------------
// Order 1: N_a = L_a. Order 2: corners L (2 L - 1), edge middles 4 L_p L_q.

template <int dim, int order>
struct SimplexElement {
  static constexpr int corners = dim + 1;
  static constexpr int edges = order == 1 ? 0 : dim * (dim + 1) / 2;

  static constexpr const int (&edge(int e))[2] {
    if constexpr (dim == 2)
      return triangle_edges[e];
    else
      return tetrahedron_edges[e];
  }
  static std::array<double, corners> barycentric(const double* xi) {
    std::array<double, corners> l;
    l[0] = 1;
    for (int i = 0; i < dim; ++i) {
      l[i + 1] = xi[i];
      l[0] -= xi[i];
    }
    return l;
  }
  /// dL_p/dξ_i
  static constexpr double slope(int p, int i) { return p == 0 ? -1.0 : (p == i + 1 ? 1.0 : 0.0); }

  static void values(const double* xi, const double*, double* out) {
    const auto l = barycentric(xi);
    for (int a = 0; a < corners; ++a)
      out[a] = order == 1 ? l[a] : l[a] * (2 * l[a] - 1);
    for (int e = 0; e < edges; ++e)
      out[corners + e] = 4 * l[edge(e)[0]] * l[edge(e)[1]];
  }
  static void gradients(const double* xi, const double*, double* out) {
    const auto l = barycentric(xi);
    for (int i = 0; i < dim; ++i) {
      for (int a = 0; a < corners; ++a)
        out[a * dim + i] = (order == 1 ? 1 : 4 * l[a] - 1) * slope(a, i);
      for (int e = 0; e < edges; ++e) {
        const auto [p, q] = edge(e);
        out[(corners + e) * dim + i] = 4 * (l[p] * slope(q, i) + l[q] * slope(p, i));
      }
    }
  }
  static void hessians(const double*, const double*, double* out) {
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        for (int a = 0; a < corners; ++a)
          out[(a * dim + i) * dim + j] = order == 1 ? 0 : 4 * slope(a, i) * slope(a, j);
        for (int e = 0; e < edges; ++e) {
          const auto [p, q] = edge(e);
          out[((corners + e) * dim + i) * dim + j] = 4 * (slope(p, i) * slope(q, j) + slope(q, i) * slope(p, j));
        }
      }
  }
};

/// Calls work(element) with the class that knows the shape functions of `type`.
template <class Work>
void with_element(ElementType type, Work&& work) {
  switch (type) {
  case ElementType::Segment2:
    return work(TensorElement<1, 1, 2>{});
  case ElementType::Segment3:
    return work(TensorElement<1, 2, 3>{});
  case ElementType::Quadrilateral4:
    return work(TensorElement<2, 1, 4>{});
  case ElementType::Quadrilateral9:
    return work(TensorElement<2, 2, 9>{});
  case ElementType::Hexahedron8:
    return work(TensorElement<3, 1, 8>{});
  case ElementType::Hexahedron27:
    return work(TensorElement<3, 2, 27>{});
  case ElementType::Triangle3:
    return work(SimplexElement<2, 1>{});
  case ElementType::Triangle6:
    return work(SimplexElement<2, 2>{});
  case ElementType::Tetrahedron4:
    return work(SimplexElement<3, 1>{});
  case ElementType::Tetrahedron10:
    return work(SimplexElement<3, 2>{});
  }
}

// --- quadrature ------------------------------------------------------------------------------------------------------

struct Rule1D {
  std::vector<double> points, weights;
};

/// Gauss-Jacobi rule of n points for ∫_0^1 f(x) (1 - x)^alpha dx, alpha = 0, 1, 2; exact to degree 2n - 1. Points are
/// the eigenvalues of the Jacobi matrix, weights the squared first components of its eigenvectors (Golub and Welsch,
/// Math. Comp. 23, 1969) times ∫ (1 - x)^alpha = 1 / (alpha + 1).
Rule1D gauss_jacobi(int n, int alpha) {
  Eigen::VectorXd diagonal(n), off(std::max(n - 1, 0));
  for (int k = 0; k < n; ++k) {
    const double s = 2.0 * k + alpha;
    diagonal[k] = alpha == 0 ? 0.0 : -double(alpha * alpha) / (s * (s + 2));
  }
  for (int k = 1; k < n; ++k) {
    const double s = 2.0 * k + alpha, product = double(k) * (k + alpha);
    off[k - 1] = std::sqrt(4 * product * product / (s * s * (s + 1) * (s - 1)));
  }
  Rule1D rule;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off);
  for (int k = 0; k < n; ++k) {
    const double first = solver.eigenvectors()(0, k);
    rule.points.push_back(0.5 * (1 + solver.eigenvalues()[k]));
    rule.weights.push_back(first * first / (alpha + 1));
  }
  return rule;
}

Quadrature gauss_product(int dim, int degree) {
  const int n = degree / 2 + 1;
  const Rule1D line = gauss_jacobi(n, 0);
  Quadrature rule;
  rule.dim = dim;
  for (int q = 0, total = static_cast<int>(std::lround(std::pow(n, dim))); q < total; ++q) {
    double weight = 1;
    for (int i = 0, rest = q; i < dim; ++i, rest /= n) {
      rule.points.push_back(2 * line.points[rest % n] - 1);
      weight *= 2 * line.weights[rest % n];
    }
    rule.weights.push_back(weight);
  }
  return rule;
}

/// The cube collapsed onto the simplex: x = u, y = v (1 - u), z = w (1 - u)(1 - v), with Jacobian (1 - u)^(dim-1)
/// (1 - v)^(dim-2) taken up by Gauss-Jacobi rules.
Quadrature collapsed_product(int dim, int degree) {
  const int n = degree / 2 + 1;
  const Rule1D u = gauss_jacobi(n, dim - 1), v = gauss_jacobi(n, dim - 2);
  const Rule1D w = dim == 3 ? gauss_jacobi(n, 0) : Rule1D{{0.0}, {1.0}};
  Quadrature rule;
  rule.dim = dim;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (std::size_t k = 0; k < w.points.size(); ++k) {
        const double rest = 1 - u.points[i];
        rule.points.insert(rule.points.end(), {u.points[i], v.points[j] * rest});
        if (dim == 3) rule.points.push_back(w.points[k] * rest * (1 - v.points[j]));
        rule.weights.push_back(u.weights[i] * v.weights[j] * w.weights[k]);
      }
  return rule;
}

/// Points of a symmetric rule: the centroid; all but one barycentric coordinate equal to a; or (tetrahedra) two equal
/// to a and two equal to 1/2 - a.
void add_centroid(Quadrature& rule, double weight) {
  rule.points.insert(rule.points.end(), rule.dim, 1.0 / (rule.dim + 1));
  rule.weights.push_back(weight);
}
void add_orbit(Quadrature& rule, double a, double weight) {
  for (int corner = 0; corner <= rule.dim; ++corner) {
    for (int i = 0; i < rule.dim; ++i)
      rule.points.push_back(corner == i + 1 ? 1 - rule.dim * a : a);
    rule.weights.push_back(weight);
  }
}
void add_edge_orbit(Quadrature& rule, double a, double weight) {
  for (const auto& [p, q] : tetrahedron_edges) {
    for (int i = 0; i < 3; ++i)
      rule.points.push_back(p == i + 1 || q == i + 1 ? a : 0.5 - a);
    rule.weights.push_back(weight);
  }
}

/// Degrees 1, 2, 4 (Dunavant, IJNME 21, 1985) and 5 (Radon, Monatsh. Math. 52, 1948).
Quadrature triangle_rule(int degree) {
  if (degree > 5) return collapsed_product(2, degree);
  Quadrature rule;
  rule.dim = 2;
  if (degree <= 1) {
    add_centroid(rule, 0.5);
  } else if (degree == 2) {
    add_orbit(rule, 1.0 / 6, 1.0 / 6);
  } else if (degree <= 4) {
    add_orbit(rule, 0.44594849091596488632, 0.5 * 0.22338158967801146570);
    add_orbit(rule, 0.09157621350977074346, 0.5 * 0.10995174365532186764);
  } else {
    const double root = std::sqrt(15.0);
    add_centroid(rule, 9.0 / 80);
    add_orbit(rule, (6 - root) / 21, (155 - root) / 2400);
    add_orbit(rule, (6 + root) / 21, (155 + root) / 2400);
  }
  return rule;
}

/// Degrees 1, 2 (4 points) and 5 (15 points; Stroud, Approximate Calculation of Multiple Integrals, 1971, T3 5-1).
Quadrature tetrahedron_rule(int degree) {
  if (degree > 5) return collapsed_product(3, degree);
  Quadrature rule;
  rule.dim = 3;
  if (degree <= 1) {
    add_centroid(rule, 1.0 / 6);
  } else if (degree == 2) {
    add_orbit(rule, (5 - std::sqrt(5.0)) / 20, 1.0 / 24);
  } else {
    const double root = std::sqrt(15.0);
    add_centroid(rule, 8.0 / 405);
    add_orbit(rule, (7 - root) / 34, (2665 + 14 * root) / 226800);
    add_orbit(rule, (7 + root) / 34, (2665 - 14 * root) / 226800);
    add_edge_orbit(rule, (10 - 2 * root) / 40, 5.0 / 567);
  }
  return rule;
}

Quadrature make_rule(ElementType type, int degree) {
  switch (type) {
  case ElementType::Triangle3:
  case ElementType::Triangle6:
    return triangle_rule(degree);
  case ElementType::Tetrahedron4:
  case ElementType::Tetrahedron10:
    return tetrahedron_rule(degree);
  default:
    return gauss_product(element_dim(type), degree);
  }
}

} // namespace

void shape_values(ElementType type, std::span<const double> xi, std::span<double> values) {
  with_element(type, [&](auto element) { element.values(xi.data(), reference_nodes(type).data(), values.data()); });
}

void shape_gradients(ElementType type, std::span<const double> xi, std::span<double> gradients) {
  with_element(type,
               [&](auto element) { element.gradients(xi.data(), reference_nodes(type).data(), gradients.data()); });
}

void shape_hessians(ElementType type, std::span<const double> xi, std::span<double> hessians) {
  with_element(type, [&](auto element) { element.hessians(xi.data(), reference_nodes(type).data(), hessians.data()); });
}

std::span<const double> reference_nodes(ElementType type) {
  const auto first = [type](std::span<const double> all) {
    return all.first(std::size_t(num_nodes(type)) * element_dim(type));
  };
  switch (type) {
  case ElementType::Segment2:
  case ElementType::Segment3:
    return first(segment_nodes);
  case ElementType::Triangle3:
  case ElementType::Triangle6:
    return first(triangle_nodes);
  case ElementType::Quadrilateral4:
  case ElementType::Quadrilateral9:
    return first(quadrilateral_nodes);
  case ElementType::Tetrahedron4:
  case ElementType::Tetrahedron10:
    return first(tetrahedron_nodes);
  default:
    return first(hexahedron_nodes);
  }
}

ElementType linear_element(ElementType type) {
  switch (type) {
  case ElementType::Segment3:
    return ElementType::Segment2;
  case ElementType::Triangle6:
    return ElementType::Triangle3;
  case ElementType::Quadrilateral9:
    return ElementType::Quadrilateral4;
  case ElementType::Tetrahedron10:
    return ElementType::Tetrahedron4;
  case ElementType::Hexahedron27:
    return ElementType::Hexahedron8;
  default:
    return type;
  }
}

const Quadrature& quadrature(ElementType type, int degree) {
  static std::map<std::pair<ElementType, int>, Quadrature> rules;
  const auto [entry, is_new] = rules.try_emplace({type, degree});
  if (is_new) entry->second = make_rule(type, degree);
  return entry->second;
}

const Tabulation& tabulation(ElementType type, int degree) {
  static std::map<std::pair<ElementType, int>, Tabulation> tables;
  const auto [entry, is_new] = tables.try_emplace({type, degree});
  Tabulation& table = entry->second;
  if (!is_new) return table;
  table.type = type;
  table.rule = &quadrature(type, degree);
  const std::size_t nodes = num_nodes(type), dim = element_dim(type), size = table.rule->size();
  table.values.resize(size * nodes);
  table.gradients.resize(size * nodes * dim);
  for (std::size_t q = 0; q < size; ++q) {
    const auto xi = table.rule->point(static_cast<int>(q));
    shape_values(type, xi, std::span(table.values).subspan(q * nodes));
    shape_gradients(type, xi, std::span(table.gradients).subspan(q * nodes * dim));
  }
  return table;
}

} // namespace amontons
