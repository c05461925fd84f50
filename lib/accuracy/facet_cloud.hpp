// Facets gathered from several ranks with the positions and displacements of their nodes, and a tree to search them.
// For lib/accuracy only.
#pragma once

#include "geometry/box_tree.hpp"
#include "geometry/projection.hpp"
#include "mesh/mesh.hpp"

#include <mpi.h>
#include <span>
#include <vector>

namespace amontons::accuracy {

/// X, or X + u.
enum class Configuration { Reference, Current };

/// Values of some local nodes (num_local x dim), node after node.
std::vector<double> nodal_values(const Mesh& mesh, std::span<const double> values, std::span<const std::int32_t> nodes);

/// Positions of some local nodes.
std::vector<double> positions_of(const Mesh& mesh, std::span<const double> displacement,
                                 std::span<const std::int32_t> nodes, Configuration configuration);

class FacetCloud {
 public:
  explicit FacetCloud(int dim) : dim_(dim) {}

  /// This rank's facets of the set.
  static FacetCloud local(const Mesh& mesh, std::span<const double> displacement, const FacetSet& facets,
                          Configuration configuration);
  /// The same at X + start (empty: X), with a displacement from there.
  static FacetCloud moving(const Mesh& mesh, std::span<const double> start, std::span<const double> displacement,
                           const FacetSet& facets);
  /// The facets of all ranks' clouds whose boxes meet `wanted` of this rank. Collective.
  FacetCloud gathered(MPI_Comm comm, const Box& wanted) const;

  int size() const { return static_cast<int>(types_.size()); }
  ElementType type(std::int32_t f) const { return types_[f]; }
  std::int32_t body(std::int32_t f) const { return bodies_[f]; }
  const Box& box(std::int32_t f) const { return boxes_[f]; }
  std::span<const double> positions(std::int32_t f) const { return part(positions_, f); }
  /// Displacement at ξ, three components.
  std::array<double, 3> displacement_at(std::int32_t f, std::span<const double> xi) const;
  /// Reference place of ξ, three components.
  std::array<double, 3> origin_at(std::int32_t f, std::span<const double> xi) const;
  double facet_size(std::int32_t f) const { return amontons::facet_size(type(f), positions(f)); }
  const BoxTree& tree() const { return tree_; }

 private:
  std::span<const double> part(const std::vector<double>& values, std::int32_t f) const {
    return std::span(values).subspan(offsets_[f], offsets_[f + 1] - offsets_[f]);
  }
  void append(ElementType type, std::int32_t body, std::span<const double> positions, std::span<const double> moved,
              std::span<const double> origins);
  std::array<double, 3> value_at(std::span<const double> values, std::int32_t f, std::span<const double> xi) const;
  void plant();

  int dim_;
  std::vector<ElementType> types_;
  std::vector<std::int32_t> bodies_;
  std::vector<std::size_t> offsets_ = {0};
  std::vector<double> positions_, displacements_, origins_; // of nodes: at the start, from there, in the reference
  std::vector<Box> boxes_;
  BoxTree tree_;
};

/// Distance between a point and a box.
double box_distance(const Box& box, std::span<const double> x);

/// Sends `outgoing[r]` to rank r; what arrived from all ranks, one after the other. Collective.
std::vector<double> exchanged(MPI_Comm comm, const std::vector<std::vector<double>>& outgoing);

/// One box of every rank. Collective.
std::vector<Box> boxes_of_ranks(MPI_Comm comm, std::span<const Box> mine);

} // namespace amontons::accuracy
