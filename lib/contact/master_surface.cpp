#include "contact/master_surface.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace amontons {

namespace {

/// Sends message[r] to rank r and returns everything received, in the order of the senders. Collective.
template <class Number>
std::vector<Number> exchange(MPI_Comm comm, MPI_Datatype type, const std::vector<std::vector<Number>>& messages) {
  const int ranks = static_cast<int>(messages.size());
  std::vector<int> send(ranks), receive(ranks), send_at(ranks + 1, 0), receive_at(ranks + 1, 0);
  std::vector<Number> outgoing;
  for (int rank = 0; rank < ranks; ++rank) {
    send[rank] = static_cast<int>(messages[rank].size());
    send_at[rank + 1] = send_at[rank] + send[rank];
    outgoing.insert(outgoing.end(), messages[rank].begin(), messages[rank].end());
  }
  MPI_Alltoall(send.data(), 1, MPI_INT, receive.data(), 1, MPI_INT, comm);
  for (int rank = 0; rank < ranks; ++rank)
    receive_at[rank + 1] = receive_at[rank] + receive[rank];
  std::vector<Number> incoming(receive_at[ranks]);
  MPI_Alltoallv(outgoing.data(), send.data(), send_at.data(), type, incoming.data(), receive.data(), receive_at.data(),
                type, comm);
  return incoming;
}

std::vector<Box> gather_boxes(MPI_Comm comm, const Box& mine) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  static_assert(sizeof(Box) == 6 * sizeof(double));
  std::vector<Box> boxes(ranks);
  MPI_Allgather(&mine, 6, MPI_DOUBLE, boxes.data(), 6, MPI_DOUBLE, comm);
  return boxes;
}

} // namespace

MasterSurface::MasterSurface(const DofLayout& layout, const FacetSet& surface, std::span<const Box> boxes,
                             const Box& reach, const MasterSmoothing& smoothing)
    : dim_(layout.dim()) {
  const auto& mesh = layout.mesh();
  const auto reaches = gather_boxes(mesh.comm, reach);
  MPI_Comm_rank(mesh.comm, &rank_);
  // A facet travels as type, body, name, then for each node its global number and its dim equations; positions apart.
  std::vector<std::vector<std::int64_t>> numbers(reaches.size());
  std::vector<std::vector<double>> positions(reaches.size());
  for (std::int32_t f = 0; f < surface.size(); ++f) {
    for (std::size_t to = 0; to < reaches.size(); ++to) {
      if (reaches[to].empty() || !boxes[f].meets(reaches[to])) continue;
      numbers[to].push_back(static_cast<std::int64_t>(surface.types[f]));
      numbers[to].push_back(surface.bodies[f]);
      numbers[to].push_back(facet_name(rank_, f));
      for (const auto node : surface.facet(f)) {
        numbers[to].push_back(mesh.global_node(node));
        for (int c = 0; c < dim_; ++c)
          numbers[to].push_back(layout.equation(node, c));
        const auto place = mesh.position(node);
        positions[to].insert(positions[to].end(), place.begin(), place.end());
      }
    }
  }
  receive(exchange(mesh.comm, MPI_INT64_T, numbers), exchange(mesh.comm, MPI_DOUBLE, positions));
  find_rim();
  if (const auto* cubic = std::get_if<CubicMaster>(&smoothing)) smooth_.emplace(*this, *cubic);
  plant();

  displacement_.assign(equations_.size(), 0.0);
  const auto size = static_cast<PetscInt>(equations_.size());
  IsHandle from;
  AMT_PETSC(ISCreateGeneral(mesh.comm, size, equations_.data(), PETSC_COPY_VALUES, from.put()));
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, local_.put()));
  const auto global = layout.new_vector();
  AMT_PETSC(VecScatterCreate(global, from, local_, nullptr, scatter_.put()));
}

void MasterSurface::receive(std::span<const std::int64_t> numbers, std::span<const double> positions) {
  std::unordered_map<std::int64_t, std::int32_t> known;
  facet_positions_.assign(positions.begin(), positions.end());
  for (std::size_t at = 0; at < numbers.size();) {
    const auto type = static_cast<ElementType>(numbers[at]);
    types_.push_back(type);
    bodies_.push_back(static_cast<std::int32_t>(numbers[at + 1]));
    facet_of_name_[numbers[at + 2]] = static_cast<std::int32_t>(names_.size());
    names_.push_back(numbers[at + 2]);
    at += 3;
    for (int a = 0; a < amontons::num_nodes(type); ++a, at += 1 + std::size_t(dim_)) {
      const auto [place, is_new] = known.try_emplace(numbers[at], num_nodes());
      if (is_new) {
        global_nodes_.push_back(numbers[at]);
        for (int c = 0; c < dim_; ++c)
          equations_.push_back(static_cast<PetscInt>(numbers[at + 1 + c]));
      }
      nodes_.push_back(place->second);
      facets_of_node_.resize(num_nodes());
      facets_of_node_[place->second].push_back(num_facets() - 1);
    }
    offsets_.push_back(static_cast<std::int32_t>(nodes_.size()));
  }
}

/// Of all nodes, where the surface stands.
std::vector<double> MasterSurface::places() const {
  std::vector<double> all(global_nodes_.size() * dim_);
  for (std::int32_t f = 0; f < num_facets(); ++f)
    for (std::size_t i = 0; i < nodes(f).size() * dim_; ++i)
      all[std::size_t(nodes(f)[i / dim_]) * dim_ + i % dim_] = positions(f)[i];
  return all;
}

void MasterSurface::plant() {
  if (smooth_) smooth_->move(places());
  std::vector<Box> boxes(num_facets());
  for (std::int32_t f = 0; f < num_facets(); ++f)
    for (std::size_t a = 0; a < nodes(f).size(); ++a)
      boxes[f].include(positions(f).subspan(a * dim_, dim_));
  for (std::int32_t f = 0; smooth_ && f < num_facets(); ++f) { // a facet lies in the hull of its control points
    const auto control = smooth_->facet(f).control;
    for (std::size_t at = 0; at < control.size(); at += dim_)
      boxes[f].include(control.subspan(at, dim_));
  }
  tree_ = BoxTree(boxes);
}

std::int32_t MasterSurface::find(std::int64_t name) const {
  const auto found = facet_of_name_.find(name);
  return found == facet_of_name_.end() ? -1 : found->second;
}

std::vector<std::int32_t> MasterSurface::neighbourhood(std::int32_t facet) const {
  std::vector<std::int32_t> near;
  for (const auto node : nodes(facet))
    near.insert(near.end(), facets_of_node_[node].begin(), facets_of_node_[node].end());
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

bool MasterSurface::share_a_node(std::int32_t a, std::int32_t b) const {
  const auto others = nodes(b);
  return std::any_of(nodes(a).begin(), nodes(a).end(),
                     [&](std::int32_t node) { return std::find(others.begin(), others.end(), node) != others.end(); });
}

ShapeTable MasterSurface::shape_table(std::int32_t facet, std::span<const double> xi) const {
  return smooth_ ? ShapeTable(smooth_->shape_table(facet, xi)) : amontons::shape_table(type(facet), xi);
}

SurfacePoint MasterSurface::at(std::int32_t facet, std::span<const double> xi) const {
  return smooth_ ? surface_point(smooth_->facet(facet), xi) : surface_point(type(facet), positions(facet), xi);
}

Projection MasterSurface::closest_point(std::int32_t facet, std::span<const double> x) const {
  return smooth_ ? amontons::closest_point(smooth_->facet(facet), x)
                 : amontons::closest_point(type(facet), positions(facet), x);
}

Projection MasterSurface::project_along(std::int32_t facet, std::span<const double> x,
                                        std::span<const double> direction) const {
  return smooth_ ? amontons::project_along(smooth_->facet(facet), x, direction)
                 : amontons::project_along(type(facet), positions(facet), x, direction);
}

void MasterSurface::move() {
  moved_positions_ = facet_positions_;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (int c = 0; c < dim_; ++c)
      moved_positions_[i * dim_ + c] += displacement_[std::size_t(nodes_[i]) * dim_ + c];
  plant();
}

void MasterSurface::find_rim() {
  if (dim_ == 2) {
    std::vector<int> uses(num_nodes(), 0);
    for (std::int32_t f = 0; f < num_facets(); ++f)
      for (int v = 0; v < 2; ++v)
        ++uses[nodes(f)[v]];
    for (std::int32_t node = 0; node < num_nodes(); ++node)
      if (uses[node] == 1) rim_.push_back(node);
    return;
  }
  std::map<std::array<std::int32_t, 2>, int> uses;
  for (std::int32_t f = 0; f < num_facets(); ++f) {
    const int corners = num_vertices(types_[f]);
    for (int v = 0; v < corners; ++v) {
      const auto [low, high] = std::minmax(nodes(f)[v], nodes(f)[(v + 1) % corners]);
      ++uses[{low, high}];
    }
  }
  for (const auto& [edge, count] : uses)
    if (count == 1) {
      rims_.push_back(edge);
      rim_.insert(rim_.end(), {edge[0], edge[1]});
    }
  std::sort(rim_.begin(), rim_.end());
}

bool MasterSurface::on_rim(std::int32_t facet, std::span<const std::int32_t> corners) const {
  const auto node = nodes(facet)[corners[0]];
  if (corners.size() == 1) return std::binary_search(rim_.begin(), rim_.end(), node);
  const auto [low, high] = std::minmax(node, nodes(facet)[corners[1]]);
  return std::binary_search(rims_.begin(), rims_.end(), std::array<std::int32_t, 2>{low, high});
}

void MasterSurface::refresh(Vec unknowns) {
  AMT_PETSC(VecScatterBegin(scatter_, unknowns, local_, INSERT_VALUES, SCATTER_FORWARD));
  AMT_PETSC(VecScatterEnd(scatter_, unknowns, local_, INSERT_VALUES, SCATTER_FORWARD));
  VecReader values(local_);
  std::copy(values.data(), values.data() + values.size(), displacement_.begin());
}

} // namespace amontons
