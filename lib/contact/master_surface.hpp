// The master facets that this rank's slave facets may meet: its own and copies ("ghosts") of other ranks' facets, sent
// to every rank whose slave box they meet, with a scatter that brings their nodes' displacements. In small kinematics
// that is done once and the surface stands in its reference positions; in finite kinematics it moves with its nodes and
// is gathered again when what it has to meet has moved on.
#pragma once

#include "contact/shape_table.hpp"
#include "contact/smooth_master.hpp"
#include "fe/dof_layout.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/projection.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace amontons {

class MasterSurface {
 public:
  /// Gathers the facets of `surface` whose boxes (one for each of this rank's) meet `reach`, this rank's region of
  /// interest. Collective.
  MasterSurface(const DofLayout& layout, const FacetSet& surface, std::span<const Box> boxes, const Box& reach,
                const MasterSmoothing& smoothing = FacetedMaster{});

  int dim() const { return dim_; }
  std::int32_t num_facets() const { return static_cast<std::int32_t>(types_.size()); }
  std::int32_t num_nodes() const { return static_cast<std::int32_t>(global_nodes_.size()); }
  ElementType type(std::int32_t facet) const { return types_[facet]; }
  std::int32_t body(std::int32_t facet) const { return bodies_[facet]; }
  /// A name of the facet that is the same on all ranks and for the whole run; and the facet of that name, or -1.
  std::int64_t name(std::int32_t facet) const { return names_[facet]; }
  std::int32_t find(std::int64_t name) const;
  /// Where facet `f` of this rank's own part of the surface stands among the gathered ones, or -1.
  std::int32_t find_own(std::int32_t f) const { return find(facet_name(rank_, f)); }
  /// The facets with which a facet shares nodes, and itself.
  std::vector<std::int32_t> neighbourhood(std::int32_t facet) const;
  bool share_a_node(std::int32_t a, std::int32_t b) const;
  /// Nodes of a facet, as numbers of this surface.
  std::span<const std::int32_t> nodes(std::int32_t facet) const {
    return std::span(nodes_).subspan(offsets_[facet], offsets_[facet + 1] - offsets_[facet]);
  }
  /// Where a facet's nodes stand (number of nodes x dim): reference positions, or after move() the current ones.
  std::span<const double> positions(std::int32_t facet) const {
    return of_facet(moved_positions_.empty() ? facet_positions_ : moved_positions_, facet);
  }
  std::span<const double> reference_positions(std::int32_t facet) const { return of_facet(facet_positions_, facet); }
  std::span<const std::int32_t> facets_at(std::int32_t node) const { return facets_of_node_[node]; }

  // The shape of facets, smoothed or not, where the surface stands:
  bool is_smooth() const { return smooth_.has_value(); }
  /// Nodes on which the shape of a facet depends, its own first.
  std::span<const std::int32_t> stencil(std::int32_t facet) const {
    return smooth_ ? smooth_->stencil(facet) : nodes(facet);
  }
  /// Shape values of the stencil's nodes and their derivatives.
  ShapeTable shape_table(std::int32_t facet, std::span<const double> xi) const;
  SurfacePoint at(std::int32_t facet, std::span<const double> xi) const;
  Projection closest_point(std::int32_t facet, std::span<const double> x) const;
  Projection project_along(std::int32_t facet, std::span<const double> x, std::span<const double> direction) const;

  /// Displacement equations of a node, dim of them.
  std::span<const PetscInt> equations(std::int32_t node) const {
    return std::span(equations_).subspan(std::size_t(node) * dim_, dim_);
  }
  /// Facets near a point.
  const BoxTree& tree() const { return tree_; }
  /// Does the feature at these corners of the facet (one corner: a vertex; two: an edge) lie on the rim of the surface,
  /// where no other known facet continues it?
  bool on_rim(std::int32_t facet, std::span<const std::int32_t> corners) const;

  /// Brings displacements of all nodes up to date with a global vector of unknowns. Collective.
  void refresh(Vec unknowns);
  /// Displacement of a node, dim components, as of the last refresh.
  std::span<const double> displacement(std::int32_t node) const {
    return std::span(displacement_).subspan(std::size_t(node) * dim_, dim_);
  }
  /// Takes all facets, also for the search, to where the last refresh has their nodes.
  void move();

 private:
  /// Facets stay on their rank.
  static std::int64_t facet_name(int rank, std::int32_t f) { return (std::int64_t(rank) << 32) + f; }
  void receive(std::span<const std::int64_t> numbers, std::span<const double> positions);
  void find_rim();
  void plant();
  std::vector<double> places() const;
  std::span<const double> of_facet(const std::vector<double>& values, std::int32_t facet) const {
    return std::span(values).subspan(std::size_t(offsets_[facet]) * dim_,
                                     std::size_t(offsets_[facet + 1] - offsets_[facet]) * dim_);
  }

  int dim_;
  int rank_ = 0;
  std::vector<ElementType> types_;
  std::vector<std::int32_t> bodies_, offsets_ = {0}, nodes_;
  std::vector<std::int64_t> names_;
  std::vector<double> facet_positions_, moved_positions_; // per entry of nodes_, dim each
  std::unordered_map<std::int64_t, std::int32_t> facet_of_name_;
  std::vector<std::vector<std::int32_t>> facets_of_node_;
  std::vector<std::int64_t> global_nodes_;
  std::vector<PetscInt> equations_;
  std::vector<double> displacement_;
  std::vector<std::int32_t> rim_;                 // nodes on the rim in 2D, sorted
  std::vector<std::array<std::int32_t, 2>> rims_; // edges on the rim in 3D, sorted
  std::optional<SmoothMaster> smooth_;
  BoxTree tree_;
  VecHandle local_;
  ScatterHandle scatter_;
};

} // namespace amontons
