// Strains, nodal forces and stiffness of one cell, for every element type and space from one template. A detail of
// form/bulk.cpp: arrays of numbers in, arrays of numbers out, no mesh and no unknowns. Plain loops of fixed length:
// twelve instances of the same in fixed-size Eigen took ten times as long to compile.
//
// Notation at a quadrature point: ∇_a the gradient of N_a; in axisymmetric space h_a = N_a / r the hoop strain of a
// unit radial displacement; d_a = ∇_a + h_a e_r the divergence, tr ε = Σ d_a · u_a. w is the weight times the volume
// that the point stands for (with 2 π r in axisymmetric space).
//
// Near incompressibility a cell of full integration cannot keep tr ε = 0 at every point; of order 1 it locks, of order
// 2 it loses an order of accuracy. `Dilatation` says what a cell does about it.
//
// Mean dilatation (B-bar; Hughes, IJNME 15, 1980): only the part of the dilatation in a small space of functions on the
// cell is kept: constants for quadrilaterals and hexahedra of order 1, all linear functions of x for those of order 2
// (the pair Q2/P1, which is stable). With an orthonormal basis ψ_k of that space, Σ w ψ_k ψ_l = δ_kl,
//     ε̄ = ε + ⅓ (tr̄ - tr ε) 1,   tr̄ = Σ_k ψ_k Σ_a D_ka · u_a,   D_ka = Σ w ψ_k d_a,
// so B̄_a = B_a + ⅓ 1 ⊗ (Σ_k ψ_k D_ka - d_a). The projection is volume-weighted, hence r-weighted in axisymmetric space.
// In plane strain ε̄_zz need not vanish at a point, but its mean does. Constant strains are reproduced (patch test), and
// the energy ½ ∫ σ(ε̄) : ε̄ gives symmetric forces.
//
// Bubble (Crouzeix and Raviart, RAIRO 7 R3, 1973): triangles and tetrahedra of order 2 have linear dilatations anyway,
// but too few displacements to go with them. One more function a cell, the vector bubble b β of math/bubble.hpp, makes
// up for it. It is zero on the boundary, so β is found cell by cell and never an unknown of the system; here it is the
// function after those of the nodes. The points feel the part of ∇b that is linear: their rule integrates it against
// the nodes' strains exactly on straight sides, and it is all that the linear dilatation has of the bubble. (The rule
// of axisymmetric space sees all of ∇b in a triangle.) What they do not see of its strain is left to a stiffness of its
// own,
//     Σ w (G' (|∇b'|² 1 + ⅓ ∇b' ⊗ ∇b')),   ∇b' ⊗ ∇b' from the table on the reference cell (`Cell::unseen`),
// that of the deviator of ∇b' β with shear modulus G': it makes β unique, and as β is of third order in the cell size
// no accuracy hangs on G'. On curved sides Σ w d_b = 0 is enforced, as the patch test asks for (Taylor, Beresford and
// Wilson, IJNME 10, 1976). In axisymmetric space the hoop strains are not linear, so the linear mean dilatation is
// taken besides.
//
// In the plane that is a stable pair with the full order. In space the bubble stabilizes the slopes of the pressure and
// leaves its means to the edge nodes, which is enough but on regular meshes of cubes cut into six tetrahedra (Kuhn):
// all faces at a diagonal of their squares lie in two planes, and two patterns of constant pressures find no
// displacement against them. Nothing within a cell can cure that.
//
// Plane stress needs none of this, as the thickness gives way. Triangles and tetrahedra of order 1 have no cure within
// the cell: they lock.
#pragma once

#include "material/elastic.hpp"
#include "math/bubble.hpp"
#include "math/reference_element.hpp"
#include "math/space.hpp"
#include "math/tensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace amontons {

/// What keeps a cell from locking near incompressibility; see above.
enum class Dilatation { Pointwise, ConstantMean, LinearMean, Bubble };

/// Degree of the quadrature. Simplices of order k get 2 (k - 1), all that straight sides need; the products of
/// quadrilaterals and hexahedra get k + 1 points a direction. Hoop strains, which are no polynomials, get more.
inline int cell_degree(ElementType type, Space space) {
  const int order = element_order(type);
  const bool simplex = num_vertices(type) == element_dim(type) + 1;
  return simplex && space != Space::Axisymmetric ? std::max(1, 2 * (order - 1)) : 2 * order;
}

/// Shape functions, and the bubble of simplices, at the points of the cell quadrature.
struct CellRule {
  const Tabulation* table;
  const BubbleTable* bubble; // null: the element has none
};

inline CellRule cell_rule(ElementType type, Space space) {
  const int degree = cell_degree(type, space);
  const bool has_bubble = type == ElementType::Triangle6 || type == ElementType::Tetrahedron10;
  return {&tabulation(type, degree), has_bubble ? &bubble_table(type, degree) : nullptr};
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

template <int dim_, int nodes_, bool axisymmetric_, Dilatation dilatation>
struct CellKernel {
  static constexpr int dim = dim_, nodes = nodes_, components = strain_size<dim>;
  static constexpr bool axisymmetric = axisymmetric_, has_bubble = dilatation == Dilatation::Bubble;
  /// Shape functions: those of the nodes, then the bubble.
  static constexpr int functions = nodes + (has_bubble ? 1 : 0), unknowns = dim * functions,
                       node_unknowns = dim * nodes;
  /// Dimension of the space of dilatations; 0: not reduced.
  static constexpr int modes = dilatation == Dilatation::ConstantMean                                 ? 1
                               : dilatation == Dilatation::LinearMean || (has_bubble && axisymmetric) ? dim + 1
                                                                                                      : 0;
  static constexpr bool mean_dilatation = modes > 0;
  static constexpr int max_points = nodes == 27 ? 27 : (nodes == 9 ? 9 : 8);

  /// Component i of function a at [a * dim + i].
  using Nodal = std::array<double, unknowns>;
  using Block = std::array<double, std::size_t(unknowns) * unknowns>; // row-major
  using NodeBlock = std::array<double, std::size_t(node_unknowns) * node_unknowns>;
  using Bubble = std::array<double, has_bubble ? dim : 0>; // β and what goes with it
  using BubbleBlock = std::array<Bubble, has_bubble ? dim : 0>;

  struct Point {
    double weight;
    Nodal gradient;
    std::array<double, axisymmetric ? functions : 0> hoop; // h_a
    std::array<double, modes> mode;                        // ψ_k

    Nodal divergence() const {
      Nodal d = gradient;
      if constexpr (axisymmetric)
        for (int a = 0; a < functions; ++a)
          d[a * dim] += hoop[a];
      return d;
    }
  };
  struct Cell {
    int size;
    std::array<Point, max_points> points;
    std::array<Nodal, modes> mean; // D_ka
    BubbleBlock unseen;            // Σ w ∂_i b' ∂_j b'
  };

  /// Everything that depends on the place of the nodes. False when a point has no volume or, in axisymmetric space,
  /// does not lie at r > 0: the cell is inverted or across the axis.
  static bool geometry(const CellRule& rule, const Nodal& X, Cell& cell) {
    const Tabulation& table = *rule.table;
    cell.size = table.rule->size();
    bool sound = true;
    if constexpr (has_bubble) cell.unseen = {};
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
      if constexpr (has_bubble) add_bubble(rule, q, X, inverse, cell);
    }
    if constexpr (has_bubble) balance_bubble(cell);
    if constexpr (mean_dilatation)
      if (sound) project_dilatation(table, X, cell);
    return sound;
  }

  /// Adds ε̄ at all points of the cell that comes from the functions first ... last - 1.
  template <int first, int last>
  static void add_strains(const Cell& cell, const Nodal& u, double* strains) {
    std::array<double, modes> means{};
    for (int k = 0; k < modes; ++k)
      for (int i = first * dim; i < last * dim; ++i)
        means[k] += cell.mean[k][i] * u[i];
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      double H[dim][dim] = {};
      for (int a = first; a < last; ++a)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            H[i][j] += u[a * dim + i] * point.gradient[a * dim + j];
      double normal[3] = {H[0][0], H[1][1], 0};
      if constexpr (dim == 3) normal[2] = H[2][2];
      if constexpr (axisymmetric)
        for (int a = first; a < last; ++a)
          normal[2] += u[a * dim] * point.hoop[a];
      double change = 0;
      if constexpr (mean_dilatation) {
        change = -(normal[0] + normal[1] + normal[2]);
        for (int k = 0; k < modes; ++k)
          change += point.mode[k] * means[k];
      }
      double* const strain = strains + q * components;
      for (int i = 0; i < 3; ++i)
        strain[i] += normal[i] + change / 3;
      strain[3] += H[0][1] + H[1][0];
      if constexpr (dim == 3) {
        strain[4] += H[1][2] + H[2][1];
        strain[5] += H[2][0] + H[0][2];
      }
    }
  }

  /// Σ w B̄_aᵀ σ for the functions a = first ... last - 1, at their places; zero for the others. With mean dilatation
  /// the pressure part p = ⅓ tr σ leaves B_aᵀ σ and comes back through D_ka.
  template <int first, int last>
  static Nodal forces(const Cell& cell, const double* stresses) {
    Nodal result{};
    std::array<double, modes> pressures{}; // Σ w ψ_k p
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      double s[components];
      for (int i = 0; i < components; ++i)
        s[i] = point.weight * stresses[q * components + i];
      if constexpr (mean_dilatation) {
        const double p = (s[0] + s[1] + s[2]) / 3;
        for (int i = 0; i < 3; ++i)
          s[i] -= p;
        for (int k = 0; k < modes; ++k)
          pressures[k] += point.mode[k] * p;
      }
      for (int a = first; a < last; ++a) {
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
    for (int k = 0; k < modes; ++k)
      for (int i = first * dim; i < last * dim; ++i)
        result[i] += pressures[k] * cell.mean[k][i];
    return result;
  }

  /// Σ w B̄ᵀ C B̄ for constant isotropic moduli, without forming B: from the weak form, with S_ab = Σ w ∇_a ⊗ ∇_b,
  ///     K_ab = G (S_abᵀ + tr S_ab 1 + 2 H_ab e_r ⊗ e_r) + c Σ w d_a ⊗ d_b + K Σ_k D_ka ⊗ D_kb
  /// where H_ab = Σ w h_a h_b. Full integration: c = λ and no last term. Mean dilatation: the deviator keeps
  /// c = -⅔ G, and the bulk modulus K = λ + ⅔ G acts on the mean part.
  static void isotropic_stiffness(const Cell& cell, const Lame& lame, Block& K) {
    const double G = lame.G, c = mean_dilatation ? -2 * G / 3 : lame.lambda, bulk = lame.lambda + 2 * G / 3;
    Block S{};
    K.fill(0); // first c Σ w d ⊗ d + K Σ D ⊗ D
    for (int q = 0; q < cell.size; ++q) {
      add_upper(cell.points[q].weight, cell.points[q].gradient, S);
      if constexpr (axisymmetric) add_upper(c * cell.points[q].weight, cell.points[q].divergence(), K);
    }
    for (int k = 0; k < modes; ++k)
      add_upper(bulk, cell.mean[k], K);
    for (int a = 0; a < functions; ++a)
      for (int b = a; b < functions; ++b) {
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

  /// The bubble's own stiffness for constant isotropic moduli, K_bb of `isotropic_stiffness` with the share of G' =
  /// `unseen_shear`.
  static BubbleBlock bubble_stiffness(const Cell& cell, const Lame& lame, double unseen_shear) {
    const double G = lame.G, c = mean_dilatation ? -2 * G / 3 : lame.lambda, bulk = lame.lambda + 2 * G / 3;
    BubbleBlock K = unseen_stiffness(cell, unseen_shear);
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      const double* const g = &point.gradient[node_unknowns];
      double d[dim], square = 0;
      for (int i = 0; i < dim; ++i) {
        d[i] = g[i];
        square += g[i] * g[i];
      }
      if constexpr (axisymmetric) {
        d[0] += point.hoop[nodes];
        K[0][0] += 2 * G * point.weight * point.hoop[nodes] * point.hoop[nodes];
      }
      for (int i = 0; i < dim; ++i) {
        K[i][i] += point.weight * G * square;
        for (int j = 0; j < dim; ++j)
          K[i][j] += point.weight * (G * g[i] * g[j] + c * d[i] * d[j]);
      }
    }
    for (int k = 0; k < modes; ++k)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          K[i][j] += bulk * cell.mean[k][node_unknowns + i] * cell.mean[k][node_unknowns + j];
    return K;
  }

  /// The same for any moduli.
  static BubbleBlock bubble_stiffness(const Cell& cell, const double* moduli, double unseen_shear) {
    BubbleBlock K = unseen_stiffness(cell, unseen_shear);
    for (int q = 0; q < cell.size; ++q) {
      const StrainOperator B = strain_operator(cell, cell.points[q]);
      const double* const C = moduli + q * components * components;
      for (int row = 0; row < components; ++row)
        for (int column = 0; column < components; ++column)
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              K[i][j] += cell.points[q].weight * C[row * components + column] * B[row][node_unknowns + i] *
                         B[column][node_unknowns + j];
    }
    return K;
  }

  /// The stiffness of what the points do not see of the bubble.
  static BubbleBlock unseen_stiffness(const Cell& cell, double unseen_shear) {
    BubbleBlock K{};
    double trace = 0;
    for (int i = 0; i < dim; ++i)
      trace += cell.unseen[i][i];
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        K[i][j] = unseen_shear * (cell.unseen[i][j] / 3 + (i == j ? trace : 0));
    return K;
  }

  /// -K⁻¹ `force`, from and to the bubble's places.
  static Nodal solve(const BubbleBlock& K, const Nodal& force) {
    double matrix[dim][dim], inverse[dim][dim];
    for (int i = 0; i < dim; ++i)
      std::copy(K[i].begin(), K[i].end(), matrix[i]);
    invert<dim>(matrix, inverse);
    Nodal result{};
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        result[node_unknowns + i] -= inverse[i][j] * force[node_unknowns + j];
    return result;
  }

  /// The stiffness of the nodes when the bubble gives way: K_uu - K_ub K_bb⁻¹ K_bu.
  static NodeBlock condensed(const Block& K, const Cell& cell, double unseen_shear) {
    const BubbleBlock unseen = unseen_stiffness(cell, unseen_shear);
    double own[dim][dim], inverse[dim][dim];
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        own[i][j] = unseen[i][j] + K[at(nodes, i, nodes, j)];
    invert<dim>(own, inverse);
    NodeBlock result;
    for (int row = 0; row < node_unknowns; ++row) {
      double factors[dim] = {}; // of this row of K_ub K_bb⁻¹
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          factors[j] += K[row * unknowns + node_unknowns + i] * inverse[i][j];
      for (int column = 0; column < node_unknowns; ++column) {
        double entry = K[row * unknowns + column];
        for (int j = 0; j < dim; ++j)
          entry -= factors[j] * K[(node_unknowns + j) * unknowns + column];
        result[row * node_unknowns + column] = entry;
      }
    }
    return result;
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
    for (int a = 0; a < functions; ++a) {
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
    if constexpr (mean_dilatation) {
      const Nodal d = point.divergence();
      for (int column = 0; column < unknowns; ++column) {
        double change = -d[column];
        for (int k = 0; k < modes; ++k)
          change += point.mode[k] * cell.mean[k][column];
        for (int i = 0; i < 3; ++i)
          B[i][column] += change / 3;
      }
    }
    return B;
  }

  /// The bubble at point q, `inverse` being ∂ξ_i/∂x_j there.
  static void add_bubble(const CellRule& rule, int q, const Nodal& X, const double (&inverse)[dim][dim], Cell& cell) {
    const BubbleTable& bubble = *rule.bubble;
    Point& point = cell.points[q];
    for (int i = 0; i < dim; ++i) {
      point.gradient[node_unknowns + i] = 0;
      for (int j = 0; j < dim; ++j)
        point.gradient[node_unknowns + i] += inverse[j][i] * bubble.gradient(q)[j];
    }
    if constexpr (axisymmetric) point.hoop[nodes] = bubble.values[q] / place(*rule.table, q, X, 0);
    for (int i = 0; i < dim; ++i)
      for (int l = 0; l < dim; ++l) {
        double half = 0; // Σ_k ∂ξ_k/∂x_i unseen_kl
        for (int k = 0; k < dim; ++k)
          half += inverse[k][i] * bubble.unseen[k * dim + l];
        for (int j = 0; j < dim; ++j)
          cell.unseen[i][j] += point.weight * half * inverse[l][j];
      }
  }

  /// Takes a constant off the bubble's gradient, so that Σ w d_b = 0. On straight sides it is zero.
  static void balance_bubble(Cell& cell) {
    Bubble mean{};
    double volume = 0;
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = cell.points[q];
      volume += point.weight;
      for (int i = 0; i < dim; ++i)
        mean[i] += point.weight * point.gradient[node_unknowns + i];
      if constexpr (axisymmetric) mean[0] += point.weight * point.hoop[nodes];
    }
    for (int q = 0; q < cell.size; ++q)
      for (int i = 0; i < dim; ++i)
        cell.points[q].gradient[node_unknowns + i] -= mean[i] / volume;
  }
};

/// Calls work(kernel) with the kernel of a plane or axisymmetric element.
template <int nodes, Dilatation dilatation, class Work>
void with_plane_kernel(Space space, Work&& work) {
  if (space == Space::Axisymmetric)
    work(CellKernel<2, nodes, true, dilatation>{});
  else if (space == Space::PlaneStrain)
    work(CellKernel<2, nodes, false, dilatation>{});
  else
    work(CellKernel<2, nodes, false, Dilatation::Pointwise>{});
}

/// Calls work(kernel) with the kernel of this element in this space: the one place that lists them all.
template <class Work>
void with_kernel(ElementType type, Space space, Work&& work) {
  switch (type) {
  case ElementType::Triangle3:
    return with_plane_kernel<3, Dilatation::Pointwise>(space, work);
  case ElementType::Triangle6:
    return with_plane_kernel<6, Dilatation::Bubble>(space, work);
  case ElementType::Quadrilateral4:
    return with_plane_kernel<4, Dilatation::ConstantMean>(space, work);
  case ElementType::Quadrilateral9:
    return with_plane_kernel<9, Dilatation::LinearMean>(space, work);
  case ElementType::Tetrahedron4:
    return work(CellKernel<3, 4, false, Dilatation::Pointwise>{});
  case ElementType::Tetrahedron10:
    return work(CellKernel<3, 10, false, Dilatation::Bubble>{});
  case ElementType::Hexahedron8:
    return work(CellKernel<3, 8, false, Dilatation::ConstantMean>{});
  case ElementType::Hexahedron27:
    return work(CellKernel<3, 27, false, Dilatation::LinearMean>{});
  default:
    return; // segments are no cells
  }
}

} // namespace amontons
