// Polynomials fitted to fields around the corner nodes of a mesh, and their blend inside cells. For lib/accuracy only.
#pragma once

#include "form/solid.hpp"

#include <Eigen/Core>
#include <vector>

namespace amontons::accuracy {

// Matrices of a cell live on the stack: there are many cells, and memory management would cost more than arithmetic.
inline constexpr int most_points = 64, most_fields = 12;
/// One point a row, whose values are neighbours in memory.
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, most_points, most_fields>;
using PointColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most_points, 1>;

/// 1, x_i, and with order 2 x_i x_j: as many as there are coefficients in a polynomial.
constexpr int num_terms(int dim, int order) { return order == 1 ? 1 + dim : 1 + dim + dim * (dim + 1) / 2; }

/// Coordinates of the batch's points in cell `c`, one a row.
PointRows point_places(const Mesh& mesh, const PointBatch& batch, std::int32_t c);
/// SolidForm::for_each_batch with the strains that errors are weighed by: those of a linear elastic solid. Otherwise no
/// strain belongs to a stress alone, and stress / E stands in for it, E the virgin Young's modulus, so that errors are
/// those of the stress in L2.
void each_weighed_batch(SolidForm& solid, const State& state, const std::function<void(const PointBatch&)>& visit);

/// Strain and stress at the points of cell `c`, side by side, one point a row.
PointRows point_fields(const PointBatch& batch, std::int32_t c);

/// Strain and stress of all cells, recovered. A node has one polynomial for each body that it belongs to.
class PatchRecovery {
 public:
  /// Collective.
  PatchRecovery(SolidForm& solid, const Mesh& mesh, const State& state);

  /// Recovered strain and stress, one place a row as in point_fields, at `places` of cell `c`, where `corners` are the
  /// values of the cell's functions of order 1 (places x corners).
  PointRows at(const CellBlock& block, std::int32_t c, const PointRows& places, const Eigen::MatrixXd& corners) const;

 private:
  /// How far the polynomial of a patch can be trusted: a mean value only, fitted from one side, fitted all around.
  enum class Standing : std::uint8_t { Mean, OneSided, Surrounded };

  void number_patches();
  template <class Sizes>
  void add_cells(const PointBatch& batch);
  void add_boundary();
  void sum_over_ranks();
  template <class Sizes>
  void fit();
  template <class Sizes>
  PointRows blend(const CellBlock& block, std::int32_t c, const PointRows& places,
                  const Eigen::MatrixXd& corners) const;
  std::int32_t patch(std::int32_t body, std::int32_t node) const { return patches_[body][node]; }

  const Mesh& mesh_;
  int terms_, fields_;
  std::size_t stride_;                             // numbers of a patch in sums_
  std::vector<NodeField> nodes_;                   // of the patches, body by body
  std::vector<std::vector<std::int32_t>> patches_; // per body and local node; -1: none
  std::vector<double> sums_; // per patch: Σ t tᵀ (upper part by rows), Σ t f (term by term), facets of the boundary
  std::vector<double> coefficients_; // per patch, term by term
  std::vector<Standing> standing_;
};

} // namespace amontons::accuracy
