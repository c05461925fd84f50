#include "accuracy/patch_recovery.hpp"

#include "fe/node_numbering.hpp"
#include "math/tensor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace amontons::accuracy {

namespace {

/// Smallest reciprocal condition of the (scaled) normal equations of a fit that is taken.
constexpr double least_condition = 1e-6;

bool is_simplex(ElementType type) { return num_vertices(type) == element_dim(type) + 1; }

/// From values at the points of a cell to those where they are fitted: stresses are one order better there than
/// elsewhere (Barlow, IJNME 10, 1976). Order 1: the mean, at the centre. Quadrilaterals and hexahedra of order 2: the
/// 2^d Gauss points, of the field's L2 projection on functions linear in each ξ_i, whose kernel is Π ½ (1 + 3 ξ_i η_i).
/// Simplices of order 2: the points themselves.
Eigen::MatrixXd sampling(const Tabulation& table) {
  const Quadrature& rule = *table.rule;
  const int size = rule.size(), dim = rule.dim;
  const Eigen::Map<const Eigen::RowVectorXd> weights(rule.weights.data(), size);
  if (element_order(table.type) == 1) return weights / weights.sum();
  if (is_simplex(table.type)) return Eigen::MatrixXd::Identity(size, size);
  Eigen::MatrixXd result(1 << dim, size);
  for (int s = 0; s < 1 << dim; ++s)
    for (int q = 0; q < size; ++q) {
      result(s, q) = weights[q];
      for (int i = 0; i < dim; ++i)
        result(s, q) *= 0.5 * (1 + std::sqrt(3.0) * (s >> i & 1 ? 1 : -1) * rule.point(q)[i]);
    }
  return result;
}

/// The corners of all bodies, on every rank that has them, whether it has a cell of that body or not. Collective.
std::vector<NodeField> corners_of_bodies(const Mesh& mesh) {
  std::vector<std::int32_t> all(mesh.num_local());
  std::iota(all.begin(), all.end(), 0);
  const NodeSpace nodes(mesh, {{"node", std::move(all)}});
  std::vector<NodeField> result;
  for (std::size_t body = 0; body < mesh.bodies.size(); ++body) {
    std::vector<std::vector<double>> marks(1, std::vector<double>(mesh.num_local(), 0.0));
    for (const auto& block : mesh.blocks)
      for (std::int32_t c = 0; block.body == static_cast<std::int32_t>(body) && c < block.size(); ++c)
        for (int a = 0; a < num_vertices(block.type); ++a)
          marks[0][block.cell(c)[a]] = 1.0;
    const VecHandle sum = nodes.new_vector();
    nodes.add(marks, sum);
    nodes.gather(sum, marks);
    auto& field = result.emplace_back(NodeField{mesh.bodies[body], {}});
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      if (marks[0][node] > 0.0) field.nodes.push_back(node);
  }
  return result;
}

} // namespace

int num_terms(int dim, int order) { return order == 1 ? 1 + dim : 1 + dim + dim * (dim + 1) / 2; }

PointRows point_places(const Mesh& mesh, const PointBatch& batch, std::int32_t c) {
  if (batch.table->rule->size() > most_points) throw std::logic_error("a quadrature has more points than most_points");
  const auto nodes = batch.block->cell(batch.first_cell + c);
  PointRows places = PointRows::Zero(batch.table->rule->size(), mesh.dim);
  for (int q = 0; q < places.rows(); ++q)
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int i = 0; i < mesh.dim; ++i)
        places(q, i) += batch.table->value(q)[a] * mesh.position(nodes[a])[i];
  return places;
}

void each_weighed_batch(SolidForm& solid, const State& state, const std::function<void(const PointBatch&)>& visit) {
  if (solid.tangent_is_constant()) return solid.for_each_batch(state, visit);
  const std::size_t components = space_dim(solid.space()) == 2 ? strain_size<2> : strain_size<3>;
  std::vector<double> strain;
  solid.for_each_batch(state, [&](const PointBatch& batch) {
    const double modulus = solid.stiffness(batch.block->body);
    strain.assign(batch.stress.begin(), batch.stress.end());
    for (std::size_t i = 0; i < strain.size(); ++i)
      strain[i] *= (i % components < 3 ? 1.0 : 2.0) / modulus;
    PointBatch weighed = batch;
    weighed.strain = strain;
    visit(weighed);
  });
}

PointRows point_fields(const PointBatch& batch, std::int32_t c) {
  const int points = batch.table->rule->size();
  const auto components = static_cast<int>(batch.strain.size() / batch.weights.size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::size_t first = std::size_t(c) * points * components;
  PointRows fields(points, 2 * components);
  fields << Eigen::Map<const Rows>(&batch.strain[first], points, components),
      Eigen::Map<const Rows>(&batch.stress[first], points, components);
  return fields;
}

PatchRecovery::PatchRecovery(SolidForm& solid, const Mesh& mesh, const State& state)
    : mesh_(mesh), terms_(num_terms(mesh.dim, mesh.order)),
      fields_(2 * (mesh.dim == 2 ? strain_size<2> : strain_size<3>)),
      stride_(std::size_t(terms_) * (terms_ + 1) / 2 + std::size_t(terms_) * fields_ + 1) {
  number_patches();
  each_weighed_batch(solid, state, [this](const PointBatch& batch) { add_cells(batch); });
  add_boundary();
  sum_over_ranks();
  fit();
}

void PatchRecovery::number_patches() {
  nodes_ = corners_of_bodies(mesh_);
  std::int32_t count = 0;
  for (const auto& field : nodes_) {
    auto& numbers = patches_.emplace_back(mesh_.num_local(), -1);
    for (const auto node : field.nodes)
      numbers[node] = count++;
  }
  sums_.assign(count * stride_, 0.0);
}

/// Of a place from a node; the third component is zero in the plane.
Eigen::Vector3d PatchRecovery::distance(const PointRows& places, Eigen::Index row, std::int32_t node) const {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int i = 0; i < mesh_.dim; ++i)
    result[i] = places(row, i) - mesh_.position(node)[i];
  return result;
}

/// The polynomial's terms at a distance from the node of the patch.
TermColumn PatchRecovery::terms(const Eigen::Vector3d& distance) const {
  TermColumn result(terms_);
  const int dim = mesh_.dim;
  result[0] = 1.0;
  result.segment(1, dim) = distance.head(dim);
  Eigen::Index next = 1 + dim;
  for (int i = 0; i < dim && next < terms_; ++i)
    for (int j = i; j < dim; ++j)
      result[next++] = distance[i] * distance[j];
  return result;
}

/// Adds to the normal equations of the patches at the cells' corners; all cells count the same.
void PatchRecovery::add_cells(const PointBatch& batch) {
  const Eigen::MatrixXd samples = sampling(*batch.table);
  for (std::int32_t c = 0; c < batch.num_cells; ++c) {
    const PointRows places = samples.lazyProduct(point_places(mesh_, batch, c)),
                    fields = samples.lazyProduct(point_fields(batch, c));
    const auto nodes = batch.block->cell(batch.first_cell + c);
    for (int a = 0; a < num_vertices(batch.block->type); ++a) {
      for (Eigen::Index s = 0; s < samples.rows(); ++s) {
        const TermColumn t = terms(distance(places, s, nodes[a]));
        double* sum = &sums_[patch(batch.block->body, nodes[a]) * stride_];
        for (int k = 0; k < terms_; ++k)
          for (int l = k; l < terms_; ++l)
            *sum++ += t[k] * t[l];
        for (int k = 0; k < terms_; ++k)
          for (int i = 0; i < fields_; ++i)
            *sum++ += t[k] * fields(s, i);
      }
    }
  }
}

void PatchRecovery::add_boundary() {
  const FacetSet& exterior = mesh_.exterior;
  for (std::int32_t f = 0; f < exterior.size(); ++f)
    for (int a = 0; a < num_vertices(exterior.types[f]); ++a)
      sums_[(patch(exterior.bodies[f], exterior.facet(f)[a]) + 1) * stride_ - 1] += 1.0;
}

/// Every part of the normal equations is a sum over cells, so each rank adds up its own and no cell travels.
void PatchRecovery::sum_over_ranks() {
  int ranks = 1;
  MPI_Comm_size(mesh_.comm, &ranks);
  if (ranks == 1) return;
  const NodeSpace space(mesh_, nodes_);
  std::vector<std::vector<double>> part(nodes_.size());
  for (std::size_t k = 0; k < stride_; ++k) {
    std::size_t next = k;
    for (std::size_t f = 0; f < nodes_.size(); ++f) {
      part[f].resize(nodes_[f].nodes.size());
      for (double& value : part[f]) {
        value = sums_[next];
        next += stride_;
      }
    }
    const VecHandle sum = space.new_vector();
    space.add(part, sum);
    space.gather(sum, part);
    next = k;
    for (const auto& values : part)
      for (const double value : values) {
        sums_[next] = value;
        next += stride_;
      }
  }
}

void PatchRecovery::fit() {
  const std::size_t count = sums_.size() / stride_, size = std::size_t(terms_) * fields_;
  coefficients_.resize(count * size);
  standing_.resize(count);
  std::vector<int> bodies(mesh_.num_local(), 0);
  for (const auto& field : nodes_)
    for (const auto node : field.nodes)
      ++bodies[node];
  std::size_t number = 0;
  for (const auto& field : nodes_)
    for (const auto node : field.nodes) {
      const auto sums = std::span(sums_).subspan(number * stride_, stride_);
      const bool on_boundary = sums.back() > 0.0 || bodies[node] > 1;
      standing_[number] = fit_patch(sums, on_boundary, std::span(coefficients_).subspan(number * size, size));
      ++number;
    }
}

/// Solves the normal equations, scaled to a unit diagonal so that the unit of length does not matter.
PatchRecovery::Standing PatchRecovery::fit_patch(std::span<const double> sums, bool on_boundary,
                                                 std::span<double> coefficients) const {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_terms, most_terms>;
  Square normal(terms_, terms_);
  std::size_t next = 0;
  for (int k = 0; k < terms_; ++k)
    for (int l = k; l < terms_; ++l)
      normal(k, l) = normal(l, k) = sums[next++];
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows> right(&sums[next], terms_, fields_);
  Eigen::Map<Rows> result(coefficients.data(), terms_, fields_);
  if (normal.diagonal().minCoeff() > 0.0) {
    const TermColumn scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Square> factor(scale.asDiagonal() * normal * scale.asDiagonal());
    if (factor.info() == Eigen::Success && factor.vectorD().minCoeff() > least_condition) {
      result = scale.asDiagonal() * factor.solve(scale.asDiagonal() * right);
      return on_boundary ? Standing::OneSided : Standing::Surrounded;
    }
  }
  result.setZero();
  if (normal(0, 0) > 0.0) result.row(0) = right.row(0) / normal(0, 0);
  return Standing::Mean;
}

/// Σ_a N_a(x) f_a(x) over the corners whose polynomials can be trusted most; they share what N_a the others have.
PointRows PatchRecovery::at(const CellBlock& block, std::int32_t c, const PointRows& places,
                            const Eigen::MatrixXd& corners) const {
  const auto nodes = block.cell(c).first(num_vertices(block.type));
  Standing best = Standing::Mean;
  for (const auto node : nodes)
    best = std::max(best, standing_[patch(block.body, node)]);
  int trusted = 0;
  PointColumn share = PointColumn::Ones(places.rows());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    if (standing_[patch(block.body, nodes[a])] == best) {
      ++trusted;
      share -= corners.col(a);
    }
  share /= trusted;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  PointRows result = PointRows::Zero(places.rows(), fields_);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const std::size_t number = patch(block.body, nodes[a]);
    if (standing_[number] != best) continue;
    const Eigen::Map<const Rows> polynomial(&coefficients_[number * terms_ * fields_], terms_, fields_);
    for (Eigen::Index q = 0; q < places.rows(); ++q)
      result.row(q) +=
          (corners(q, a) + share[q]) * terms(distance(places, q, nodes[a])).transpose().lazyProduct(polynomial);
  }
  return result;
}

} // namespace amontons::accuracy
