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

/// Dilatation of the nodes' displacements less that of the strains at the points of a cell.
template <int dim>
PointColumn less_dilatation(Space space, const Mesh& mesh, const PointBatch& batch, std::int32_t c,
                            std::span<const double> displacement) {
  using Square = Eigen::Matrix<double, dim, dim>;
  using Column = Eigen::Map<const Eigen::Vector<double, dim>>;
  const Tabulation& table = *batch.table;
  const int points = table.rule->size();
  const auto nodes = batch.block->cell(batch.first_cell + c);
  const auto components = batch.strain.size() / batch.weights.size();
  PointColumn result(points);
  for (int q = 0; q < points; ++q) {
    Square jacobian = Square::Zero(), slope = Square::Zero(); // d/dξ of X and u
    double radius = 0.0, radial = 0.0;
    const auto values = table.value(q), gradients = table.gradient(q);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const Column x(mesh.position(nodes[a]).data()), u(&displacement[std::size_t(nodes[a]) * dim]),
          gradient(&gradients[a * dim]);
      radius += values[a] * x[0];
      radial += values[a] * u[0];
      jacobian += x * gradient.transpose();
      slope += u * gradient.transpose();
    }
    const double* strain = &batch.strain[(std::size_t(c) * points + q) * components];
    const double hoop = space == Space::Axisymmetric && radius > 0.0 ? radial / radius : 0.0;
    result[q] = (slope * jacobian.inverse()).trace() + hoop - (strain[0] + strain[1] + strain[2]);
  }
  return result;
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
  const ElementType corners = linear_element(batch.block->type);
  const bool has_mean = corners == ElementType::Quadrilateral4 || corners == ElementType::Hexahedron8;
  if (!has_mean || space == Space::PlaneStress) return PointColumn::Zero(batch.table->rule->size());
  return mesh.dim == 2 ? less_dilatation<2>(space, mesh, batch, c, displacement)
                       : less_dilatation<3>(space, mesh, batch, c, displacement);
}

} // namespace amontons::accuracy
