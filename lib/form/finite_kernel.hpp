// Nodal forces and stiffness of one cell at finite strain, total Lagrangian: from the first Piola-Kirchhoff stress P
// and its derivative at the quadrature points. A detail of form/finite_bulk.cpp; geometry and notation are those of
// form/cell_kernel.hpp, with all gradients taken in the reference configuration.
//
// Near incompressibility a cell of full integration locks. As at small strain (`Dilatation` of cell_kernel.hpp) only
// the part of the volume ratio J = det F in a small space of functions is kept: with the orthonormal basis ψ_k of
// constants (order 1) or linear functions (order 2) on the reference cell
//     F̄ = (θ / J)^⅓ F,   θ = Σ_k ψ_k Θ_k,   Θ_k = Σ w ψ_k J,   so that det F̄ = θ,
// and the law sees F̄. F̄ itself is that of E. A. de Souza Neto, D. Peric, M. Dutko, D. R. J. Owen (Int. J. Solids
// Struct. 33, 1996, "F-bar") but for θ, which there is J at the centre of the cell. Theirs takes the stress of F̄ for a
// Cauchy stress in the true configuration; here forces are the derivative of the energy Σ w W(F̄), or for a law with
// memory the virtual work Σ w P̄ : δF̄, P̄ = P(F̄). For elastic laws that is the mean dilatation method of J. C. Simo,
// R. L. Taylor, K. S. Pister (Comput. Methods Appl. Mech. Eng. 51, 1985) with Hu-Washizu's pressure eliminated. The
// tangent is symmetric where dP/dF is, and external work is the energy of the points to the last digit, which the
// certificate checks. Homogeneous deformations are reproduced (patch test).
//
// Derivation, with f = F^-T, α = (θ / J)^⅓, s = ⅓ P̄ : F̄, and δJ = J f : δF:
//     δF̄ = α (δF + δβ F),  δβ = ⅓ (δθ / θ − f : δF),  δθ = Σ_k ψ_k T_k · δu,  T_k = Σ w ψ_k J Gᵀ f,
// where G is the operator δF = G δu. With the pressures p_k = Σ w ψ_k s / θ and π = Σ_k ψ_k p_k, the forces are
//     Σ w P̄ : δF̄ = Σ w P* : δF,   P* = α P̄ + (J π − s) f.
// Their derivative, A = dP/dF at F̄, X : δF ⊗ ΔF = tr(F^-1 ΔF F^-1 δF):
//     Σ w [ Gᵀ A* G + Gᵀ v ⊗ t + t ⊗ Gᵀ v' + κ t ⊗ t ],   t = Σ_k ψ_k T_k,
//     A* = α² Q A Qᵀ − ⅓ α (f ⊗ P̄ + P̄ ⊗ f) + (⅓ s + J π) f ⊗ f + (s − J π) X,   Q = 1 − ⅓ f ⊗ F,
//     v = (α² Q A F + α P̄ − s f) / (3 θ),  v' the same with Aᵀ,  κ = (α² F : A F / 9 − ⅔ s) / θ².
// Without mean dilatation P* = P̄ and A* = A.
#pragma once

#include "form/cell_kernel.hpp"
#include "math/spectral.hpp"

namespace amontons {

/// `Geometry`: a CellKernel without bubble.
template <class Geometry>
struct FiniteKernel : Geometry {
  using Geometry::axisymmetric, Geometry::dim, Geometry::max_points, Geometry::modes, Geometry::nodes,
      Geometry::unknowns;
  using typename Geometry::Block, typename Geometry::Cell, typename Geometry::Nodal;
  using Shape = typename Geometry::Point;
  static_assert(!Geometry::has_bubble);

  using Nine = std::array<double, 9>; // a tensor, F_iJ at 3 i + J

  struct Point {
    Nine F, f;
    double J, theta, alpha;
  };
  struct Deformation {
    std::array<Point, max_points> points;
  };

  /// The deformation of a cell, and F̄ at its points (nine numbers each). False where J or θ is not positive: the cell
  /// is turned inside out.
  static bool deform(const Cell& cell, const Nodal& u, Deformation& deformation, double* gradients) {
    bool sound = true;
    std::array<double, modes> means{}; // Θ_k
    for (int q = 0; q < cell.size; ++q) {
      Point& point = deformation.points[q];
      point.F = gradient(cell.points[q], u);
      point.J = point.theta = transposed_inverse(point.F, point.f);
      point.alpha = 1;
      sound = sound && point.J > 0;
      for (int k = 0; k < modes; ++k)
        means[k] += cell.points[q].weight * cell.points[q].mode[k] * point.J;
    }
    for (int q = 0; q < cell.size; ++q) {
      Point& point = deformation.points[q];
      if constexpr (modes > 0) {
        point.theta = 0;
        for (int k = 0; k < modes; ++k)
          point.theta += cell.points[q].mode[k] * means[k];
        sound = sound && point.theta > 0;
        if (sound) point.alpha = std::cbrt(point.theta / point.J);
      }
      for (int i = 0; i < 9; ++i)
        gradients[9 * q + i] = point.alpha * point.F[i];
    }
    return sound;
  }

  /// Turns P̄ (nine numbers a point) into P*, the stress that works on δF.
  static void effective_stress(const Cell& cell, const Deformation& deformation, const double* piola, double* result) {
    const auto pressures = mean_pressures(cell, deformation, piola);
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = deformation.points[q];
      const double* const P = piola + 9 * q;
      const double extra = modes > 0 ? point.J * pressure(cell.points[q], pressures) - third_of_work(point, P) : 0.0;
      for (int i = 0; i < 9; ++i)
        result[9 * q + i] = point.alpha * P[i] + extra * point.f[i];
    }
  }

  /// Σ w Gᵀ P*.
  static Nodal forces(const Cell& cell, const double* effective) {
    Nodal result{};
    for (int q = 0; q < cell.size; ++q)
      add_transposed(cell.points[q], cell.points[q].weight, effective + 9 * q, result);
    return result;
  }

  /// Σ w P* : (F − 1).
  static double work(const Cell& cell, const Deformation& deformation, const double* effective) {
    double sum = 0;
    for (int q = 0; q < cell.size; ++q)
      for (int i = 0; i < 9; ++i)
        sum += cell.points[q].weight * effective[9 * q + i] * (deformation.points[q].F[i] - (i % 4 == 0 ? 1.0 : 0.0));
    return sum;
  }

  /// The derivative of the forces; `tangents`: dP/dF at F̄, 81 numbers a point.
  static void stiffness(const Cell& cell, const Deformation& deformation, const double* piola, const double* tangents,
                        Block& K) {
    K.fill(0);
    if constexpr (modes == 0) {
      for (int q = 0; q < cell.size; ++q)
        add_point_stiffness(cell.points[q], tangents + 81 * q, K);
      return;
    }
    const auto pressures = mean_pressures(cell, deformation, piola);
    std::array<Nodal, modes> T{}, left{}, right{};
    std::array<double, std::size_t(modes) * modes> kappa{};
    std::array<double, 81> effective;
    for (int q = 0; q < cell.size; ++q) {
      const Point& point = deformation.points[q];
      const Shape& shape = cell.points[q];
      Nine v, v_transposed;
      const double curvature = effective_tangent(point, piola + 9 * q, tangents + 81 * q, pressure(shape, pressures),
                                                 effective, v, v_transposed);
      add_point_stiffness(shape, effective.data(), K);
      for (int k = 0; k < modes; ++k) {
        const double weight = shape.weight * shape.mode[k];
        add_transposed(shape, weight * point.J, point.f.data(), T[k]);
        add_transposed(shape, weight, v.data(), left[k]);
        add_transposed(shape, weight, v_transposed.data(), right[k]);
        for (int l = 0; l < modes; ++l)
          kappa[k * modes + l] += weight * shape.mode[l] * curvature;
      }
    }
    for (int k = 0; k < modes; ++k) {
      for (int l = 0; l < modes; ++l)
        for (int i = 0; i < unknowns; ++i)
          left[k][i] += kappa[k * modes + l] * T[l][i];
      for (int row = 0; row < unknowns; ++row)
        for (int column = 0; column < unknowns; ++column)
          K[row * unknowns + column] += left[k][row] * T[k][column] + T[k][row] * right[k][column];
    }
  }

 private:
  /// F = 1 + ∂u/∂X; F_33 = 1 + u_r / R in axisymmetric space.
  static Nine gradient(const Shape& shape, const Nodal& u) {
    Nine F{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          F[3 * i + j] += u[a * dim + i] * shape.gradient[a * dim + j];
    if constexpr (axisymmetric)
      for (int a = 0; a < nodes; ++a)
        F[8] += u[a * dim] * shape.hoop[a];
    return F;
  }

  /// f = F^-T; returns det F.
  static double transposed_inverse(const Nine& F, Nine& f) {
    double m[3][3], inverse[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        m[i][j] = F[3 * i + j];
    const double det = invert<3>(m, inverse);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        f[3 * i + j] = inverse[j][i];
    return det;
  }

  /// s = ⅓ P̄ : F̄.
  static double third_of_work(const Point& point, const double* P) {
    double sum = 0;
    for (int i = 0; i < 9; ++i)
      sum += P[i] * point.F[i];
    return point.alpha * sum / 3;
  }

  /// p_k.
  static std::array<double, modes> mean_pressures(const Cell& cell, const Deformation& deformation,
                                                  const double* piola) {
    std::array<double, modes> pressures{};
    for (int q = 0; q < cell.size && modes > 0; ++q) {
      const Point& point = deformation.points[q];
      const double density = cell.points[q].weight * third_of_work(point, piola + 9 * q) / point.theta;
      for (int k = 0; k < modes; ++k)
        pressures[k] += density * cell.points[q].mode[k];
    }
    return pressures;
  }

  /// π.
  static double pressure(const Shape& shape, const std::array<double, modes>& pressures) {
    double sum = 0;
    for (int k = 0; k < modes; ++k)
      sum += shape.mode[k] * pressures[k];
    return sum;
  }

  /// Adds weight Gᵀ t.
  static void add_transposed(const Shape& shape, double weight, const double* t, Nodal& sum) {
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          sum[a * dim + i] += weight * t[3 * i + j] * shape.gradient[a * dim + j];
    if constexpr (axisymmetric)
      for (int a = 0; a < nodes; ++a)
        sum[a * dim] += weight * t[8] * shape.hoop[a];
  }

  /// Adds w Gᵀ A G, each column of G having at most dim + 1 entries.
  static void add_point_stiffness(const Shape& shape, const double* A, Block& K) {
    for (int b = 0; b < nodes; ++b)
      for (int k = 0; k < dim; ++k) {
        double AG[9]; // column (b, k) of w A G
        for (int r = 0; r < 9; ++r) {
          double sum = 0;
          for (int j = 0; j < dim; ++j)
            sum += A[9 * r + 3 * k + j] * shape.gradient[b * dim + j];
          if constexpr (axisymmetric)
            if (k == 0) sum += A[9 * r + 8] * shape.hoop[b];
          AG[r] = shape.weight * sum;
        }
        double* const column = K.data() + b * dim + k;
        for (int a = 0; a < nodes; ++a) {
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              column[(a * dim + i) * unknowns] += AG[3 * i + j] * shape.gradient[a * dim + j];
          if constexpr (axisymmetric) column[a * dim * unknowns] += AG[8] * shape.hoop[a];
        }
      }
  }

  /// A*, v and v'; returns κ.
  static double effective_tangent(const Point& point, const double* P, const double* A, double pi,
                                  std::array<double, 81>& effective, Nine& v, Nine& v_transposed) {
    const Nine &F = point.F, &f = point.f;
    const double alpha = point.alpha, s = third_of_work(point, P), Jpi = point.J * pi;
    Nine AF{}, FA{};
    double FAF = 0;
    for (int r = 0; r < 9; ++r)
      for (int c = 0; c < 9; ++c) {
        AF[r] += A[9 * r + c] * F[c];
        FA[c] += F[r] * A[9 * r + c];
      }
    for (int r = 0; r < 9; ++r)
      FAF += F[r] * AF[r];
    const double square = alpha * alpha;
    for (int r = 0; r < 9; ++r)
      for (int c = 0; c < 9; ++c) {
        const double QAQ = A[9 * r + c] - (f[r] * FA[c] + AF[r] * f[c]) / 3 + FAF / 9 * f[r] * f[c];
        const double X = f[3 * (c / 3) + r % 3] * f[3 * (r / 3) + c % 3];
        effective[9 * r + c] =
            square * QAQ - alpha / 3 * (f[r] * P[c] + P[r] * f[c]) + (s / 3 + Jpi) * f[r] * f[c] + (s - Jpi) * X;
      }
    for (int r = 0; r < 9; ++r) {
      const double common = alpha * P[r] - s * f[r] - square * FAF / 3 * f[r];
      v[r] = (square * AF[r] + common) / (3 * point.theta);
      v_transposed[r] = (square * FA[r] + common) / (3 * point.theta);
    }
    return (square * FAF / 9 - 2 * s / 3) / (point.theta * point.theta);
  }
};

/// Calls work(kernel) with the finite kernel of this element in this space. Simplices are integrated as they are: the
/// bubble of those of order 2 is a construction of small strain. There is none for plane stress.
template <class Work>
void with_finite_kernel(ElementType type, Space space, Work&& work) {
  const auto plane = [&]<int nodes, Dilatation dilatation>() {
    if (space == Space::Axisymmetric)
      work(FiniteKernel<CellKernel<2, nodes, true, dilatation>>{});
    else
      work(FiniteKernel<CellKernel<2, nodes, false, dilatation>>{});
  };
  switch (type) {
  case ElementType::Triangle3:
    return plane.template operator()<3, Dilatation::Pointwise>();
  case ElementType::Triangle6:
    return plane.template operator()<6, Dilatation::Pointwise>();
  case ElementType::Quadrilateral4:
    return plane.template operator()<4, Dilatation::ConstantMean>();
  case ElementType::Quadrilateral9:
    return plane.template operator()<9, Dilatation::LinearMean>();
  case ElementType::Tetrahedron4:
    return work(FiniteKernel<CellKernel<3, 4, false, Dilatation::Pointwise>>{});
  case ElementType::Tetrahedron10:
    return work(FiniteKernel<CellKernel<3, 10, false, Dilatation::Pointwise>>{});
  case ElementType::Hexahedron8:
    return work(FiniteKernel<CellKernel<3, 8, false, Dilatation::ConstantMean>>{});
  case ElementType::Hexahedron27:
    return work(FiniteKernel<CellKernel<3, 27, false, Dilatation::LinearMean>>{});
  default:
    return; // segments are no cells
  }
}

} // namespace amontons
