#include "accuracy/facet_cloud.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace amontons::accuracy {

namespace {

int num_ranks(MPI_Comm comm) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

} // namespace

std::vector<double> nodal_values(const Mesh& mesh, std::span<const double> values,
                                 std::span<const std::int32_t> nodes) {
  std::vector<double> result;
  result.reserve(nodes.size() * mesh.dim);
  for (const std::int32_t node : nodes) {
    const auto at_node = values.subspan(std::size_t(node) * mesh.dim, mesh.dim);
    result.insert(result.end(), at_node.begin(), at_node.end());
  }
  return result;
}

std::vector<double> positions_of(const Mesh& mesh, std::span<const double> displacement,
                                 std::span<const std::int32_t> nodes, Configuration configuration) {
  std::vector<double> result = nodal_values(mesh, mesh.coordinates, nodes);
  if (configuration == Configuration::Reference) return result;
  const std::vector<double> moved = nodal_values(mesh, displacement, nodes);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] += moved[i];
  return result;
}

FacetCloud FacetCloud::local(const Mesh& mesh, std::span<const double> displacement, const FacetSet& facets,
                             Configuration configuration) {
  const bool is_reference = configuration == Configuration::Reference;
  return moving(mesh, is_reference ? std::span<const double>() : displacement, displacement, facets);
}

FacetCloud FacetCloud::moving(const Mesh& mesh, std::span<const double> start, std::span<const double> displacement,
                              const FacetSet& facets) {
  const auto configuration = start.empty() ? Configuration::Reference : Configuration::Current;
  FacetCloud cloud(mesh.dim);
  for (std::int32_t f = 0; f < facets.size(); ++f)
    cloud.append(facets.types[f], facets.bodies[f], positions_of(mesh, start, facets.facet(f), configuration),
                 nodal_values(mesh, displacement, facets.facet(f)),
                 nodal_values(mesh, mesh.coordinates, facets.facet(f)));
  cloud.plant();
  return cloud;
}

FacetCloud FacetCloud::gathered(MPI_Comm comm, const Box& wanted) const {
  const std::vector<Box> boxes = boxes_of_ranks(comm, std::span(&wanted, 1));
  std::vector<std::vector<double>> outgoing(boxes.size());
  std::vector<std::int32_t> found;
  for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
    tree_.query(boxes[rank], found);
    for (const std::int32_t f : found) {
      auto& message = outgoing[rank];
      message.push_back(static_cast<double>(types_[f]));
      message.push_back(bodies_[f]);
      for (const auto values : {positions(f), part(displacements_, f), part(origins_, f)})
        message.insert(message.end(), values.begin(), values.end());
    }
  }
  const std::vector<double> arrived = exchanged(comm, outgoing);
  FacetCloud cloud(dim_);
  for (std::size_t at = 0; at < arrived.size();) {
    const auto type = static_cast<ElementType>(arrived[at]);
    const std::size_t count = std::size_t(num_nodes(type)) * dim_;
    const std::span<const double> values = std::span(arrived).subspan(at + 2, 3 * count);
    cloud.append(type, static_cast<std::int32_t>(arrived[at + 1]), values.first(count), values.subspan(count, count),
                 values.last(count));
    at += 2 + 3 * count;
  }
  cloud.plant();
  return cloud;
}

std::array<double, 3> FacetCloud::value_at(std::span<const double> values, std::int32_t f,
                                           std::span<const double> xi) const {
  std::array<double, 9> shape;
  const int count = num_nodes(types_[f]);
  shape_values(types_[f], xi.first(element_dim(types_[f])), std::span(shape).first(count));
  std::array<double, 3> result{};
  for (int a = 0; a < count; ++a)
    for (int c = 0; c < dim_; ++c)
      result[c] += shape[a] * values[a * dim_ + c];
  return result;
}

std::array<double, 3> FacetCloud::displacement_at(std::int32_t f, std::span<const double> xi) const {
  return value_at(part(displacements_, f), f, xi);
}

std::array<double, 3> FacetCloud::origin_at(std::int32_t f, std::span<const double> xi) const {
  return value_at(part(origins_, f), f, xi);
}

void FacetCloud::append(ElementType type, std::int32_t body, std::span<const double> positions,
                        std::span<const double> moved, std::span<const double> origins) {
  types_.push_back(type);
  bodies_.push_back(body);
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  displacements_.insert(displacements_.end(), moved.begin(), moved.end());
  origins_.insert(origins_.end(), origins.begin(), origins.end());
  offsets_.push_back(positions_.size());
}

void FacetCloud::plant() {
  boxes_.resize(types_.size());
  for (std::int32_t f = 0; f < size(); ++f) {
    const auto nodes = positions(f);
    for (std::size_t i = 0; i < nodes.size(); i += dim_)
      boxes_[f].include(nodes.subspan(i, dim_));
    // A curved facet bulges out of the box of its nodes by less than that box's size.
    if (element_order(types_[f]) == 2) boxes_[f].inflate(0.25 * boxes_[f].diagonal());
  }
  tree_ = BoxTree(boxes_);
}

double box_distance(const Box& box, std::span<const double> x) {
  double sum = 0.0;
  for (std::size_t c = 0; c < x.size(); ++c) {
    const double outside = std::max({0.0, box.low[c] - x[c], x[c] - box.high[c]});
    sum += outside * outside;
  }
  return std::sqrt(sum);
}

std::vector<double> exchanged(MPI_Comm comm, const std::vector<std::vector<double>>& outgoing) {
  const int ranks = num_ranks(comm);
  std::vector<int> send_counts(ranks), send_offsets(ranks + 1, 0), receive_counts(ranks), receive_offsets(ranks + 1, 0);
  std::vector<double> sent;
  for (int rank = 0; rank < ranks; ++rank) {
    send_counts[rank] = static_cast<int>(outgoing[rank].size());
    send_offsets[rank + 1] = send_offsets[rank] + send_counts[rank];
    sent.insert(sent.end(), outgoing[rank].begin(), outgoing[rank].end());
  }
  MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm);
  std::partial_sum(receive_counts.begin(), receive_counts.end(), receive_offsets.begin() + 1);
  std::vector<double> received(receive_offsets[ranks]);
  MPI_Alltoallv(sent.data(), send_counts.data(), send_offsets.data(), MPI_DOUBLE, received.data(),
                receive_counts.data(), receive_offsets.data(), MPI_DOUBLE, comm);
  return received;
}

std::vector<Box> boxes_of_ranks(MPI_Comm comm, std::span<const Box> mine) {
  static_assert(sizeof(Box) == 6 * sizeof(double));
  const int count = 6 * static_cast<int>(mine.size());
  std::vector<Box> all(mine.size() * num_ranks(comm));
  MPI_Allgather(mine.data(), count, MPI_DOUBLE, all.data(), count, MPI_DOUBLE, comm);
  return all;
}

} // namespace amontons::accuracy
