// Strains, nodal forces and stiffness of one cell, for every element type and space from one template. A detail of
// form/bulk.cpp: arrays of numbers in, arrays of numbers out, no mesh and no unknowns. Plain loops of fixed length:
// twelve instances of the same in fixed-size Eigen took ten times as long to compile.
//
// Notation at a quadrature point: ∇_a the gradient of N_a; in axisymmetric space h_a = N_a / r the hoop strain of a
// unit radial displacement; d_a = ∇_a + h_a e_r the divergence, tr ε = Σ d_a · u_a. w is the weight times the volume
// that the point stands for (with 2 π r in axisymmetric space).
//
// Mean dilatation (B-bar; Hughes, IJNME 15, 1980): with nearly incompressible material a cell of full integration
// cannot keep tr ε = 0 at every point; of order 1 it locks, of order 2 it loses an order of accuracy. Only the part of
// the dilatation in a small space of functions on the cell is kept: constants for order 1, all linear functions of x
// for order 2 (the pair Q2/P1, which is stable). With an orthonormal basis ψ_k of that space, Σ w ψ_k ψ_l = δ_kl,
//     ε̄ = ε + ⅓ (tr̄ - tr ε) 1,   tr̄ = Σ_k ψ_k Σ_a D_ka · u_a,   D_ka = Σ w ψ_k d_a,
// so B̄_a = B_a + ⅓ 1 ⊗ (Σ_k ψ_k D_ka - d_a). The projection is volume-weighted, hence r-weighted in axisymmetric space.
// In plane strain ε̄_zz need not vanish at a point, but its mean does. Constant strains are reproduced (patch test), and
// the energy ½ ∫ σ(ε̄) : ε̄ gives symmetric forces. Plane stress needs none of this, as the thickness gives way;
// simplices have no such pair that keeps their order: of order 1 they lock, of order 2 they lose one order near
// incompressibility.
#pragma once

#include "material/law.hpp"
#include "math/reference_element.hpp"
#include "math/space.hpp"
#include "math/tensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace amontons {

/// How the cells of one type are integrated.
struct CellRule {
  const Tabulation* table;
  bool mean_dilatation;
};

/// Degree of the quadrature. Simplices of order k get 2 (k - 1), all that straight sides need; the products of
/// quadrilaterals and hexahedra get k + 1 points a direction. Hoop strains, which are no polynomials, get more.
inline int cell_degree(ElementType type, Space space) {
  const int order = element_order(type);
  const bool simplex = num_vertices(type) == element_dim(type) + 1;
  return simplex && space != Space::Axisymmetric ? std::max(1, 2 * (order - 1)) : 2 * order;
}

inline CellRule cell_rule(ElementType type, Space space) {
  const bool simplex = num_vertices(type) == element_dim(type) + 1;
  return {&tabulation(type, cell_degree(type, space)), !simplex && space != Space::PlaneStress};
}

/// Inverse of a small matrix (adjugate over determinant); returns the determinant.
template <int dim>
double invert(const double (&m)[dim][dim], double (&inverse)[dim][dim]) {
  if constexpr (dim == 2) {
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    inverse[0][0] = m[1][1] / det;
    inverse[0][1] = -m[0][1] / det;
    inverse[1][0] = -m[1][0] / det;
    inverse[1][1] = m[0][0] / det;
    return det;
  } else {
    double det = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int p = (j + 1) % 3, q = (j + 2) % 3, r = (i + 1) % 3, s = (i + 2) % 3;
        inverse[i][j] = m[p][r] * m[q][s] - m[p][s] * m[q][r]; // cofactor of m[j][i]
        if (i == 0) det += m[j][0] * inverse[0][j];
      }
    for (auto& row : inverse)
      for (double& entry : row)
        entry /= det;
    return det;
  }
}

template <int dim_, int nodes_, bool axisymmetric_>
struct CellKernel {
  static constexpr int dim = dim_, nodes = nodes_, unknowns = dim * nodes, components = strain_size<dim>;
  static constexpr bool axisymmetric = axisymmetric_;
  /// Dimension of the space of dilatations; 0: not reduced.
  static constexpr int modes = nodes == (1 << dim) ? 1 : (nodes == 9 || nodes == 27 ? dim + 1 : 0);
  static constexpr int max_points = nodes == 27 ? 27 : (nodes == 9 ? 9 : 8);

  /// Component i of node a at [a * dim + i].
  using Nodal = std::array<double, unknowns>;
  using Block = std::array<double, std::size_t(unknowns) * unknowns>; // row-major

  struct Point {
    double weight;
    Nodal gradient;
    std::array<double, axisymmetric ? nodes : 0> hoop; // h_a
    std::array<double, modes> mode;                    // ψ_k

    Nodal divergence() const {
      Nodal d = gradient;
      if constexpr (axisymmetric)
        for (int a = 0; a < nodes; ++a)
          d[a * dim] += hoop[a];
      return d;
    }
  };
  struct Cell {
    int size;
    bool mean_dilatation;
    std::array<Point, max_points> points;
    std::array<Nodal, modes> mean; // D_ka
  };

  /// Everything that depends on the place of the nodes. False when a point has no volume or, in axisymmetric space,
  /// does not lie at r > 0: the cell is inverted or across the axis.
  static bool geometry(const CellRule& rule, const Nodal& X, Cell& cell) {
    const Tabulation& table = *rule.table;
    cell.size = table.rule->size();
    cell.mean_dilatation = modes > 0 && rule.mean_dilatation;
    bool sound = true;
    for (int q = 0; q < cell.size; ++q) {
      Point& point = cell.points[q];
      const double* const reference = table.gradient(q).data();
      double jacobian[dim][dim] = {}, inverse[dim][dim]; // ∂x_i/∂ξ_j
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            jacobian[i][j] += X[a * dim + i] * reference[a * dim + j];
      const double det = invert<dim>(jacobian, inverse);
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < dim; ++i) {
          double slope = 0;
          for (int j = 0; j < dim; ++j)
            slope += inverse[j][i] * reference[a * dim + j];
          point.gradient[a * dim + i] = slope;
        }
      point.weight = table.rule->weights[q] * det;
      sound = sound && det > 0;
      if constexpr (axisymmetric) {
        const double r = place(table, q, X, 0);
        for (int a = 0; a < nodes; ++a)
          point.hoop[a] = table.value(q)[a] / r;
        point.weight *= circumference(Space::Axisymmetric, r);
        sound = sound && r > 0;
      }
    }
    if constexpr (modes > 0)
      if (cell.mean_dilatation && sound) project_dilatation(table, X, cell);
    return sound;
  }

  /// ε̄ at all points of the cell.
  static void strains(const Cell& cell, const Nodal& u, double* out) {
    std::array<double, modes> means{};
    if (cell.mean_dilatation)
      for (int k = 0; k < modes; ++k)
        for (int i = 0; i < unknowns; ++i)
          means[k] += cell.mean[k][i] * u[i];
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      double H[dim][dim] = {};
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            H[i][j] += u[a * dim + i] * point.gradient[a * dim + j];
      double* const strain = out + q * components;
      strain[0] = H[0][0];
      strain[1] = H[1][1];
      strain[2] = 0;
      strain[3] = H[0][1] + H[1][0];
      if constexpr (dim == 3) {
        strain[2] = H[2][2];
        strain[4] = H[1][2] + H[2][1];
        strain[5] = H[2][0] + H[0][2];
      }
      if constexpr (axisymmetric)
        for (int a = 0; a < nodes; ++a)
          strain[2] += u[a * dim] * point.hoop[a];
      if (cell.mean_dilatation) {
        double change = -(strain[0] + strain[1] + strain[2]);
        for (int k = 0; k < modes; ++k)
          change += point.mode[k] * means[k];
        for (int i = 0; i < 3; ++i)
          strain[i] += change / 3;
      }
    }
  }

  /// Σ w B̄_aᵀ σ. With mean dilatation the pressure part p = ⅓ tr σ leaves B_aᵀ σ and comes back through D_ka.
  static Nodal forces(const Cell& cell, const double* stresses) {
    Nodal result{};
    std::array<double, modes> pressures{}; // Σ w ψ_k p
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      double s[components];
      for (int i = 0; i < components; ++i)
        s[i] = point.weight * stresses[q * components + i];
      if (cell.mean_dilatation) {
        const double p = (s[0] + s[1] + s[2]) / 3;
        for (int i = 0; i < 3; ++i)
          s[i] -= p;
        for (int k = 0; k < modes; ++k)
          pressures[k] += point.mode[k] * p;
      }
      for (int a = 0; a < nodes; ++a) {
        const double* const g = &point.gradient[a * dim];
        double* const f = &result[a * dim];
        if constexpr (dim == 2) {
          f[0] += s[0] * g[0] + s[3] * g[1];
          f[1] += s[3] * g[0] + s[1] * g[1];
        } else {
          f[0] += s[0] * g[0] + s[3] * g[1] + s[5] * g[2];
          f[1] += s[3] * g[0] + s[1] * g[1] + s[4] * g[2];
          f[2] += s[5] * g[0] + s[4] * g[1] + s[2] * g[2];
        }
        if constexpr (axisymmetric) f[0] += s[2] * point.hoop[a];
      }
    }
    if (cell.mean_dilatation)
      for (int k = 0; k < modes; ++k)
        for (int i = 0; i < unknowns; ++i)
          result[i] += pressures[k] * cell.mean[k][i];
    return result;
  }

  /// Σ w B̄ᵀ C B̄ for constant isotropic moduli, without forming B: from the weak form, with S_ab = Σ w ∇_a ⊗ ∇_b,
  ///     K_ab = G (S_abᵀ + tr S_ab 1 + 2 H_ab e_r ⊗ e_r) + c Σ w d_a ⊗ d_b + K Σ_k D_ka ⊗ D_kb
  /// where H_ab = Σ w h_a h_b. Full integration: c = λ and no last term. Mean dilatation: the deviator keeps
  /// c = -⅔ G, and the bulk modulus K = λ + ⅔ G acts on the mean part.
  static void isotropic_stiffness(const Cell& cell, const Lame& lame, Block& K) {
    const double G = lame.G, c = cell.mean_dilatation ? -2 * G / 3 : lame.lambda, bulk = lame.lambda + 2 * G / 3;
    Block S{};
    K.fill(0); // first c Σ w d ⊗ d + K Σ D ⊗ D
    for (int q = 0; q < cell.size; ++q) {
      add_upper(cell.points[q].weight, cell.points[q].gradient, S);
      if constexpr (axisymmetric) add_upper(c * cell.points[q].weight, cell.points[q].divergence(), K);
    }
    if (cell.mean_dilatation)
      for (int k = 0; k < modes; ++k)
        add_upper(bulk, cell.mean[k], K);
    for (int a = 0; a < nodes; ++a)
      for (int b = a; b < nodes; ++b) {
        double trace = 0;
        for (int i = 0; i < dim; ++i)
          trace += S[at(a, i, b, i)];
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j) {
            double entry = K[at(a, i, b, j)] + G * S[at(a, j, b, i)];
            if (!axisymmetric) entry += c * S[at(a, i, b, j)];
            if (i == j) entry += G * trace;
            K[at(a, i, b, j)] = entry;
          }
        if constexpr (axisymmetric)
          for (int q = 0; q < cell.size; ++q)
            K[at(a, 0, b, 0)] += 2 * G * cell.points[q].weight * cell.points[q].hoop[a] * cell.points[q].hoop[b];
      }
    for (int row = 0; row < unknowns; ++row)
      for (int column = 0; column < row - row % dim; ++column)
        K[row * unknowns + column] = K[column * unknowns + row];
  }

  /// Σ w B̄ᵀ C B̄ for any moduli, components x components a point.
  static void stiffness(const Cell& cell, const double* moduli, Block& K) {
    K.fill(0);
    for (int q = 0; q < cell.size; ++q) {
      const StrainOperator B = strain_operator(cell, cell.points[q]);
      const double* const C = moduli + q * components * components;
      for (int i = 0; i < components; ++i) {
        double CB[unknowns] = {}; // row i of w C B
        for (int j = 0; j < components; ++j)
          for (int column = 0; column < unknowns; ++column)
            CB[column] += cell.points[q].weight * C[i * components + j] * B[j][column];
        for (int row = 0; row < unknowns; ++row)
          for (int column = 0; column < unknowns; ++column)
            K[row * unknowns + column] += B[i][row] * CB[column];
      }
    }
  }

 private:
  using StrainOperator = std::array<Nodal, components>;

  /// Index in a block of component i of node a and component j of node b.
  static constexpr std::size_t at(int a, int i, int b, int j) {
    return std::size_t(a * dim + i) * unknowns + b * dim + j;
  }

  /// Coordinate i of point q.
  static double place(const Tabulation& table, int q, const Nodal& X, int i) {
    double x = 0;
    for (int a = 0; a < nodes; ++a)
      x += table.value(q)[a] * X[a * dim + i];
    return x;
  }

  /// The orthonormal ψ_k from 1 and the coordinates (about node 0, in units of the distance to the opposite corner) by
  /// modified Gram-Schmidt with the weights w; and D_ka.
  static void project_dilatation(const Tabulation& table, const Nodal& X, Cell& cell) {
    double size = 0;
    for (int i = 0; i < dim; ++i)
      size += std::abs(X[2 * dim + i] - X[i]);
    for (int q = 0; q < cell.size; ++q)
      for (int k = 0; k < modes; ++k)
        cell.points[q].mode[k] = k == 0 ? 1.0 : (place(table, q, X, k - 1) - X[k - 1]) / size;
    const auto product = [&](int k, int l) {
      double sum = 0;
      for (int q = 0; q < cell.size; ++q)
        sum += cell.points[q].weight * cell.points[q].mode[k] * cell.points[q].mode[l];
      return sum;
    };
    for (int k = 0; k < modes; ++k) {
      for (int l = 0; l < k; ++l) {
        const double part = product(k, l);
        for (int q = 0; q < cell.size; ++q)
          cell.points[q].mode[k] -= part * cell.points[q].mode[l];
      }
      const double norm = std::sqrt(product(k, k));
      cell.mean[k].fill(0);
      for (int q = 0; q < cell.size; ++q) {
        Point& point = cell.points[q];
        point.mode[k] /= norm;
        const Nodal d = point.divergence();
        for (int i = 0; i < unknowns; ++i)
          cell.mean[k][i] += point.weight * point.mode[k] * d[i];
      }
    }
  }

  /// Adds w v ⊗ v on and above the diagonal blocks.
  static void add_upper(double weight, const Nodal& v, Block& sum) {
    for (int row = 0; row < unknowns; ++row) {
      const double factor = weight * v[row];
      double* const target = sum.data() + row * unknowns;
      for (int column = row - row % dim; column < unknowns; ++column)
        target[column] += factor * v[column];
    }
  }

  static StrainOperator strain_operator(const Cell& cell, const Point& point) {
    StrainOperator B{};
    for (int a = 0; a < nodes; ++a) {
      const int x = a * dim, y = x + 1, z = x + 2;
      const double* const g = &point.gradient[x];
      for (int i = 0; i < dim; ++i)
        B[i][x + i] = g[i];
      B[3][x] = g[1];
      B[3][y] = g[0];
      if constexpr (dim == 3) {
        B[4][y] = g[2];
        B[4][z] = g[1];
        B[5][z] = g[0];
        B[5][x] = g[2];
      }
      if constexpr (axisymmetric) B[2][x] = point.hoop[a];
    }
    if (!cell.mean_dilatation) return B;
    const Nodal d = point.divergence();
    for (int column = 0; column < unknowns; ++column) {
      double change = -d[column];
      for (int k = 0; k < modes; ++k)
        change += point.mode[k] * cell.mean[k][column];
      for (int i = 0; i < 3; ++i)
        B[i][column] += change / 3;
    }
    return B;
  }
};

/// Calls work(kernel) with the kernel of this element in this space: the one place that lists them all.
template <class Work>
void with_kernel(ElementType type, Space space, Work&& work) {
  const auto plane = [&]<int nodes>(std::integral_constant<int, nodes>) {
    if (space == Space::Axisymmetric)
      work(CellKernel<2, nodes, true>{});
    else
      work(CellKernel<2, nodes, false>{});
  };
  switch (type) {
  case ElementType::Triangle3:
    return plane(std::integral_constant<int, 3>{});
  case ElementType::Triangle6:
    return plane(std::integral_constant<int, 6>{});
  case ElementType::Quadrilateral4:
    return plane(std::integral_constant<int, 4>{});
  case ElementType::Quadrilateral9:
    return plane(std::integral_constant<int, 9>{});
  case ElementType::Tetrahedron4:
    return work(CellKernel<3, 4, false>{});
  case ElementType::Tetrahedron10:
    return work(CellKernel<3, 10, false>{});
  case ElementType::Hexahedron8:
    return work(CellKernel<3, 8, false>{});
  case ElementType::Hexahedron27:
    return work(CellKernel<3, 27, false>{});
  default:
    return; // segments are no cells
  }
}

} // namespace amontons
