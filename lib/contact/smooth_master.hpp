// The optional smoothing of a meshed master: every linear facet is replaced by a cubic one through its nodes, so that
// the surface has a continuous tangent plane and a point that slides over it feels no edges. Not constructed unless a
// pair asks for it.
#pragma once

#include "contact/contact_pair.hpp"
#include "geometry/bezier_facet.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

class MasterSurface;

/// Control points of smoothed facets as fixed combinations of nodes: facet's own and those of its neighbours (the
/// "stencil"). So places on the surface are linear in nodal places, ρ = Σ N_a(ξ) x_a with N_a of the stencil's nodes,
/// and everything that is derived for shape functions holds. Derivation and references in the source file.
class SmoothMaster {
 public:
  /// From the reference positions of a surface of segments or bilinear quadrilaterals.
  SmoothMaster(const MasterSurface& surface, const CubicMaster& smoothing);
  /// Nodes of the surface on which a facet's shape depends, its own first.
  std::span<const std::int32_t> stencil(std::int32_t facet) const { return facets_[facet].stencil; }
  /// Shape values of the stencil's nodes (a column each), rows as in BernsteinTable.
  BernsteinTable shape_table(std::int32_t facet, std::span<const double> xi) const;
  /// Takes the control points to where the nodes are: `places` of all nodes of the surface, dim each.
  void move(std::span<const double> places);
  BezierFacet facet(std::int32_t facet) const { return {dim_, facets_[facet].control}; }

 private:
  struct Facet {
    std::vector<std::int32_t> stencil;
    Eigen::MatrixXd weights; // control points x stencil
    std::vector<double> control;
  };
  int dim_;
  std::vector<Facet> facets_;
};

} // namespace amontons
