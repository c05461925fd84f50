#include "accuracy/patch_recovery.hpp"

#include "fe/node_numbering.hpp"
#include "math/tensor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace amontons::accuracy {

namespace {

/// Smallest reciprocal condition of the (scaled) normal equations of a fit that is taken.
constexpr double least_condition = 1e-6;

/// Of a patch, as constants: loops over terms and fields are most of the work here.
template <int dimension, int order>
struct PatchSizes {
  static constexpr int dim = dimension, terms = num_terms(dimension, order), fields = 2 * strain_size<dimension>;
};

/// Calls a function with the sizes of the patches of a mesh.
template <class Function>
auto with_sizes(const Mesh& mesh, const Function& function) {
  if (mesh.dim == 2) return mesh.order == 1 ? function(PatchSizes<2, 1>{}) : function(PatchSizes<2, 2>{});
  return mesh.order == 1 ? function(PatchSizes<3, 1>{}) : function(PatchSizes<3, 2>{});
}

/// The polynomial's terms at a place, by its distance from the node of the patch.
template <class Sizes>
std::array<double, Sizes::terms> terms_at(const double* place, std::span<const double> node) {
  constexpr int dim = Sizes::dim;
  std::array<double, Sizes::terms> result{1.0};
  for (int i = 0; i < dim; ++i)
    result[1 + i] = place[i] - node[i];
  for (int i = 0, next = 1 + dim; i < dim && next < Sizes::terms; ++i)
    for (int j = i; j < dim; ++j)
      result[next++] = result[1 + i] * result[1 + j];
  return result;
}

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
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  std::optional<NodeSpace> shared;
  if (ranks > 1) {
    std::vector<std::int32_t> all(mesh.num_local());
    std::iota(all.begin(), all.end(), 0);
    shared.emplace(mesh, std::vector<NodeField>{{"node", std::move(all)}});
  }
  std::vector<NodeField> result;
  for (std::size_t body = 0; body < mesh.bodies.size(); ++body) {
    std::vector<std::vector<double>> marks(1, std::vector<double>(mesh.num_local(), 0.0));
    for (const auto& block : mesh.blocks)
      for (std::int32_t c = 0; block.body == static_cast<std::int32_t>(body) && c < block.size(); ++c)
        for (int a = 0; a < num_vertices(block.type); ++a)
          marks[0][block.cell(c)[a]] = 1.0;
    if (shared) {
      const VecHandle sum = shared->new_vector();
      shared->add(marks, sum);
      shared->gather(sum, marks);
    }
    auto& field = result.emplace_back(NodeField{mesh.bodies[body], {}});
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      if (marks[0][node] > 0.0) field.nodes.push_back(node);
  }
  return result;
}

/// Solves the normal equations of a patch, scaled to a unit diagonal so that the unit of length does not matter. False
/// where they are (nearly) singular: then only the mean value is known.
template <class Sizes>
bool fit_patch(std::span<const double> sums, std::span<double> coefficients) {
  using Square = Eigen::Matrix<double, Sizes::terms, Sizes::terms>;
  using Rows = Eigen::Matrix<double, Sizes::terms, Sizes::fields, Eigen::RowMajor>;
  Square normal;
  std::size_t next = 0;
  for (int k = 0; k < Sizes::terms; ++k)
    for (int l = k; l < Sizes::terms; ++l)
      normal(k, l) = normal(l, k) = sums[next++];
  const Eigen::Map<const Rows> right(&sums[next]);
  Eigen::Map<Rows> result(coefficients.data());
  if (normal.diagonal().minCoeff() > 0.0) {
    const Eigen::Vector<double, Sizes::terms> scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Square> factor(scale.asDiagonal() * normal * scale.asDiagonal());
    if (factor.info() == Eigen::Success && factor.vectorD().minCoeff() > least_condition) {
      result = scale.asDiagonal() * factor.solve(scale.asDiagonal() * right);
      return true;
    }
  }
  result.setZero();
  if (normal(0, 0) > 0.0) result.row(0) = right.row(0) / normal(0, 0);
  return false;
}

} // namespace

PointRows point_places(const Mesh& mesh, const PointBatch& batch, std::int32_t c) {
  if (batch.table->rule->size() > most_points) throw std::logic_error("a quadrature has more points than most_points");
  const auto nodes = batch.block->cell(batch.first_cell + c);
  PointRows places = PointRows::Zero(batch.table->rule->size(), mesh.dim);
  const double* value = batch.table->values.data();
  for (int q = 0; q < places.rows(); ++q)
    for (const auto node : nodes) {
      const double weight = *value++;
      for (int i = 0; i < mesh.dim; ++i)
        places(q, i) += weight * mesh.coordinates[std::size_t(node) * mesh.dim + i];
    }
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
  PointRows fields(points, 2 * components);
  for (int q = 0; q < points; ++q) {
    const std::size_t first = (std::size_t(c) * points + q) * components;
    std::copy_n(&batch.strain[first], components, &fields(q, 0));
    std::copy_n(&batch.stress[first], components, &fields(q, components));
  }
  return fields;
}

PatchRecovery::PatchRecovery(SolidForm& solid, const Mesh& mesh, const State& state)
    : mesh_(mesh), terms_(num_terms(mesh.dim, mesh.order)),
      fields_(2 * (mesh.dim == 2 ? strain_size<2> : strain_size<3>)),
      stride_(std::size_t(terms_) * (terms_ + 1) / 2 + std::size_t(terms_) * fields_ + 1) {
  number_patches();
  with_sizes(mesh, [&]<class Sizes>(Sizes) {
    each_weighed_batch(solid, state, [this](const PointBatch& batch) { add_cells<Sizes>(batch); });
    add_boundary();
    sum_over_ranks();
    fit<Sizes>();
  });
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

/// Adds to the normal equations of the patches at the cells' corners; all cells count the same.
template <class Sizes>
void PatchRecovery::add_cells(const PointBatch& batch) {
  const Eigen::MatrixXd samples = sampling(*batch.table);
  for (std::int32_t c = 0; c < batch.num_cells; ++c) {
    const PointRows places = samples.lazyProduct(point_places(mesh_, batch, c)),
                    fields = samples.lazyProduct(point_fields(batch, c));
    const auto nodes = batch.block->cell(batch.first_cell + c);
    for (int a = 0; a < num_vertices(batch.block->type); ++a) {
      for (Eigen::Index s = 0; s < samples.rows(); ++s) {
        const auto t = terms_at<Sizes>(&places(s, 0), mesh_.position(nodes[a]));
        std::array<double, Sizes::fields> field; // of its own, so that the compiler may add several at once
        std::copy_n(&fields(s, 0), Sizes::fields, field.begin());
        double* sum = &sums_[patch(batch.block->body, nodes[a]) * stride_];
        for (int k = 0; k < Sizes::terms; ++k)
          for (int l = k; l < Sizes::terms; ++l)
            *sum++ += t[k] * t[l];
        for (int k = 0; k < Sizes::terms; ++k, sum += Sizes::fields)
          for (int i = 0; i < Sizes::fields; ++i)
            sum[i] += t[k] * field[i];
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

template <class Sizes>
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
      const bool is_fitted = fit_patch<Sizes>(sums, std::span(coefficients_).subspan(number * size, size));
      standing_[number] = !is_fitted ? Standing::Mean : on_boundary ? Standing::OneSided : Standing::Surrounded;
      ++number;
    }
}

PointRows PatchRecovery::at(const CellBlock& block, std::int32_t c, const PointRows& places,
                            const Eigen::MatrixXd& corners) const {
  return with_sizes(mesh_, [&]<class Sizes>(Sizes) { return blend<Sizes>(block, c, places, corners); });
}

/// Σ_a N_a(x) f_a(x) over the corners whose polynomials can be trusted most; they share what N_a the others have.
template <class Sizes>
PointRows PatchRecovery::blend(const CellBlock& block, std::int32_t c, const PointRows& places,
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
  PointRows result(places.rows(), Sizes::fields);
  for (Eigen::Index q = 0; q < places.rows(); ++q) {
    std::array<double, Sizes::fields> sum{}; // of its own, so that the compiler may add several fields at once
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const std::size_t number = patch(block.body, nodes[a]);
      if (standing_[number] != best) continue;
      const auto t = terms_at<Sizes>(&places(q, 0), mesh_.position(nodes[a]));
      const double* coefficient = &coefficients_[number * Sizes::terms * Sizes::fields];
      const double share_of_node = corners(q, a) + share[q];
      for (int k = 0; k < Sizes::terms; ++k, coefficient += Sizes::fields)
        for (int i = 0; i < Sizes::fields; ++i)
          sum[i] += share_of_node * t[k] * coefficient[i];
    }
    std::copy(sum.begin(), sum.end(), &result(q, 0));
  }
  return result;
}

} // namespace amontons::accuracy
