#include "accuracy/discretization_error.hpp"

#include "accuracy/facet_cloud.hpp"
#include "accuracy/recovery_error.hpp"
#include "fe/node_numbering.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

using accuracy::CellDifference, accuracy::ErrorRule, accuracy::PatchRecovery, accuracy::PointRows;

constexpr std::size_t statuses = 3; // of ContactStatus

/// Which cells lie near the edge of contact.
class EdgeRegion {
 public:
  explicit EdgeRegion(std::span<const ContactEdgePoint> edge) : tree_(boxes(edge)) {}

  bool meets(const Mesh& mesh, std::span<const double> displacement, std::span<const std::int32_t> nodes) {
    Box box;
    for (const auto node : nodes) {
      std::array<double, 3> place{};
      for (int i = 0; i < mesh.dim; ++i)
        place[i] = mesh.position(node)[i] + displacement[std::size_t(node) * mesh.dim + i];
      box.include(place);
    }
    tree_.query(box, found_);
    return !found_.empty();
  }

 private:
  static std::vector<Box> boxes(std::span<const ContactEdgePoint> edge) {
    std::vector<Box> result(edge.size());
    for (std::size_t i = 0; i < edge.size(); ++i) {
      result[i].include(edge[i].place);
      result[i].inflate(edge[i].size);
    }
    return result;
  }

  BoxTree tree_;
  std::vector<std::int32_t> found_;
};

/// Squares of the error and of the solution in a cell.
std::array<double, 2> squares(const CellDifference& cell) {
  const auto work = [&](const PointRows& f) {
    const auto half = f.cols() / 2;
    return f.leftCols(half).cwiseProduct(f.rightCols(half)).rowwise().sum().dot(cell.volumes);
  };
  return {work(cell.error), work(cell.fields)};
}

} // namespace

std::vector<ContactEdgePoint> contact_edge(const Mesh& mesh, std::span<const double> displacement,
                                           std::span<const std::string> slaves,
                                           std::span<const ContactSamples> samples) {
  std::vector<double> mine; // place and size, four numbers a point
  for (std::size_t pair = 0; pair < slaves.size(); ++pair) {
    const auto& nodes = mesh.node_groups.at(slaves[pair]);
    std::vector<std::int32_t> index(mesh.num_local(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      index[nodes[i]] = static_cast<std::int32_t>(i);
    // Around each node: points of every status, all points, sum of their facets' sizes.
    std::vector<std::vector<double>> counts(statuses + 1, std::vector<double>(nodes.size(), 0.0));
    const FacetSet& facets = mesh.surfaces.at(slaves[pair]);
    const ContactSamples& points = samples[pair];
    for (std::size_t q = 0; q < points.size(); ++q)
      for (int a = 0; a < num_vertices(facets.types[points.facet[q]]); ++a) {
        const auto node = index[facets.facet(points.facet[q])[a]];
        counts[static_cast<std::size_t>(points.status[q])][node] += 1.0;
        counts[statuses][node] += points.facet_size[q];
      }
    const NodeSpace space(mesh, {{slaves[pair], nodes}});
    for (auto& count : counts) {
      std::vector<std::vector<double>> local = {count};
      const VecHandle sum = space.new_vector();
      space.add(local, sum);
      space.gather(sum, local);
      count = local[0];
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double all = counts[0][i] + counts[1][i] + counts[2][i];
      const bool mixed = std::max({counts[0][i], counts[1][i], counts[2][i]}) < all;
      if (!mixed || nodes[i] >= mesh.num_owned) continue;
      for (int c = 0; c < 3; ++c)
        mine.push_back(c < mesh.dim ? mesh.position(nodes[i])[c] + displacement[std::size_t(nodes[i]) * mesh.dim + c]
                                    : 0.0);
      mine.push_back(counts[statuses][i] / all);
    }
  }
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  const auto all = accuracy::exchanged(mesh.comm, std::vector<std::vector<double>>(ranks, mine));
  std::vector<ContactEdgePoint> edge;
  for (std::size_t i = 0; i + 3 < all.size(); i += 4)
    edge.push_back({{all[i], all[i + 1], all[i + 2]}, all[i + 3]});
  return edge;
}

double DiscretizationError::relative() const { return error > 0.0 ? error / std::hypot(error, solution) : 0.0; }

double DiscretizationError::relative_near_edge() const {
  return near_edge > 0.0 ? near_edge / std::hypot(near_edge, solution_near_edge) : 0.0;
}

double DiscretizationError::edge_share() const { return error > 0.0 ? std::pow(near_edge / error, 2) : 0.0; }

DiscretizationError estimate_discretization_error(SolidForm& solid, const Mesh& mesh, const State& state,
                                                  std::span<const ContactEdgePoint> edge) {
  const PatchRecovery recovery(solid, mesh, state);
  EdgeRegion region(edge);
  DiscretizationError result;
  const accuracy::CellIndex index(mesh);
  result.cells.resize(index.size());
  result.cell_near_edge.resize(index.size());
  std::array<double, 4> sums{}; // squares of error, near_edge, solution, solution_near_edge
  accuracy::each_weighed_batch(solid, state, [&](const PointBatch& batch) {
    const ErrorRule rule(*batch.table);
    for (std::int32_t c = 0; c < batch.num_cells; ++c) {
      const auto [error, solution] = squares(difference(recovery, rule, mesh, batch, c));
      const bool near = region.meets(mesh, state.displacement, batch.block->cell(batch.first_cell + c));
      const std::size_t cell = index(batch, c);
      result.cells[cell] = error;
      result.cell_near_edge[cell] = near;
      sums[0] += error;
      sums[2] += solution;
      if (!near) continue;
      sums[1] += error;
      sums[3] += solution;
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, mesh.comm);
  for (double& sum : sums)
    sum = std::sqrt(std::max(0.0, sum));
  result.error = sums[0];
  result.near_edge = sums[1];
  result.solution = sums[2];
  result.solution_near_edge = sums[3];
  return result;
}

} // namespace amontons
