#include "accuracy/recovery_error.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace amontons::accuracy {

namespace {

/// Continues a field of order p - 1 by least squares: a row for each new point, a column for each old one.
Eigen::MatrixXd continuation_of(const Quadrature& from, const Quadrature& to, int order) {
  const auto polynomial = [order](const Quadrature& rule) {
    Eigen::MatrixXd terms = Eigen::MatrixXd::Ones(rule.size(), order == 1 ? 1 : 1 + rule.dim);
    for (int q = 0; q < rule.size(); ++q)
      for (Eigen::Index i = 1; i < terms.cols(); ++i)
        terms(q, i) = rule.point(q)[i - 1];
    return terms;
  };
  return polynomial(to) * polynomial(from).completeOrthogonalDecomposition().pseudoInverse();
}

/// Volumes that the points of the rule stand for in a cell of volume Σ `own`.
PointColumn volumes(const ErrorRule& rule, std::span<const double> own) {
  const Eigen::Map<const Eigen::VectorXd> given(own.data(), own.size());
  if (rule.continuation.size() == 0) return given;
  const auto& weights = rule.table->rule->weights;
  const Eigen::Map<const Eigen::VectorXd> parts(weights.data(), weights.size());
  return parts * (given.sum() / parts.sum());
}

} // namespace

ErrorRule::ErrorRule(const Tabulation& own) : table(&own) {
  const int order = element_order(own.type), dim = element_dim(own.type);
  if (own.rule->size() < num_terms(dim, order)) {
    table = &tabulation(own.type, 2 * order);
    continuation = continuation_of(*own.rule, *table->rule, order);
  }
  const ElementType corner_type = linear_element(own.type);
  const Quadrature& points = *table->rule;
  corners.resize(points.size(), num_nodes(corner_type));
  std::vector<double> values(num_nodes(corner_type));
  for (int q = 0; q < points.size(); ++q) {
    shape_values(corner_type, points.point(q), values);
    for (std::size_t a = 0; a < values.size(); ++a)
      corners(q, a) = values[a];
  }
}

CellDifference difference(const PatchRecovery& recovery, const ErrorRule& rule, const Mesh& mesh,
                          const PointBatch& batch, std::int32_t c) {
  const auto points = static_cast<std::size_t>(batch.table->rule->size());
  PointBatch fine = batch;
  fine.table = rule.table;
  CellDifference cell{.error = {}, .fields = point_fields(batch, c), .volumes = {}};
  if (rule.continuation.size() > 0) cell.fields = PointRows(rule.continuation.lazyProduct(cell.fields));
  cell.error = recovery.at(*batch.block, batch.first_cell + c, point_places(mesh, fine, c), rule.corners) - cell.fields;
  cell.volumes = volumes(rule, batch.weights.subspan(c * points, points));
  return cell;
}

PointColumn left_out_dilatation(Space space, const Mesh& mesh, const PointBatch& batch, std::int32_t c,
                                std::span<const double> displacement) {
  const Tabulation& table = *batch.table;
  const int points = table.rule->size(), dim = mesh.dim;
  const ElementType corners = linear_element(batch.block->type);
  const bool has_mean = corners == ElementType::Quadrilateral4 || corners == ElementType::Hexahedron8;
  if (!has_mean || space == Space::PlaneStress) return PointColumn::Zero(points);
  const auto nodes = batch.block->cell(batch.first_cell + c);
  const auto components = batch.strain.size() / batch.weights.size();
  PointColumn result(points);
  for (int q = 0; q < points; ++q) {
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity(), slope = Eigen::Matrix3d::Zero(); // d/dξ of X and u
    jacobian.topLeftCorner(dim, dim).setZero();
    double radius = 0.0, radial = 0.0;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const double* u = &displacement[std::size_t(nodes[a]) * dim];
      radius += table.value(q)[a] * mesh.position(nodes[a])[0];
      radial += table.value(q)[a] * u[0];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) {
          jacobian(i, j) += table.gradient(q)[a * dim + j] * mesh.position(nodes[a])[i];
          slope(i, j) += table.gradient(q)[a * dim + j] * u[i];
        }
    }
    const double* strain = &batch.strain[(std::size_t(c) * points + q) * components];
    const double hoop = space == Space::Axisymmetric && radius > 0.0 ? radial / radius : 0.0;
    result[q] = (slope * jacobian.inverse()).trace() + hoop - (strain[0] + strain[1] + strain[2]);
  }
  return result;
}

} // namespace amontons::accuracy
