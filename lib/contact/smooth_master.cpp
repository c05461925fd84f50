// Tangents. At a node c the line of nodes a', c, a (in 3D a line of the grid of quadrilaterals) has the tangent of the
// parabola through the three (A. W. Overhauser, 1968), with lengths h' = |c − a'| and h = |a − c| of the reference
// configuration in 2D and equal ones in 3D:
//   d = −h / (h' (h' + h)) a' + (h − h') / (h' h) c + h' / (h (h' + h)) a
// Both facets at c have it, so the surface is C¹ there. Where the line ends (rim, crease, no grid) the facet takes the
// parabola through the next three nodes, d_c = 2 (a − c) / h − d_a, and one that has no neighbours stays straight.
// 2D: the cubic Hermite segment with these tangents; its control points are c and c + h d / 3.
// 3D: the product of two, with the mean over the facets at c of c − n_u − n_v + o (the mixed derivative of the bilinear
// facet with corners c, n_u, o, n_v) as the mixed derivative. Cross derivatives along an edge are a cubic of data at
// its two nodes that both facets share, so the surface is C¹ over edges between nodes where four quadrilaterals meet.
// On arcs the 2D curve is off by O(h⁴) where the facets are by O(h²).
//
// C¹ surfaces for contact: P. Wriggers, L. Krstulovic-Opara, J. Korelc, Int. J. Numer. Meth. Engng. 51 (2001)
// 1469-1495; V. Padmanabhan, T. A. Laursen, Finite Elem. Anal. Des. 37 (2001) 173-198.
#include "contact/smooth_master.hpp"

#include "contact/master_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace amontons {

namespace {

constexpr std::int32_t no_node = -1;

/// Σ weight · place of node.
using Combination = std::map<std::int32_t, double>;

void add(Combination& sum, const Combination& other, double factor) {
  for (const auto& [node, weight] : other)
    sum[node] += factor * weight;
}

/// Lines of nodes over the facets of a surface.
class Lines {
 public:
  Lines(const MasterSurface& surface, int dim, double crease)
      : surface_(surface), dim_(dim), cosine_(std::cos(crease)) {}

  /// The node that goes on from a over c, where the line bends by less than the crease's angle: the only one next to c
  /// that shares no facet with a, and the other way round.
  std::int32_t beyond(std::int32_t c, std::int32_t a) const {
    const auto other = across(c, a);
    if (other == no_node || across(c, other) != a) return no_node;
    const Eigen::Vector3d before = place(c) - place(other), after = place(a) - place(c);
    return before.dot(after) > cosine_ * before.norm() * after.norm() ? other : no_node;
  }

  /// Derivative at c towards its neighbour a, times the length of the way.
  Combination slope(std::int32_t c, std::int32_t a) const {
    const auto before = beyond(c, a);
    if (before != no_node) return inner_slope(before, c, a);
    Combination sum = {{c, -1.0}, {a, 1.0}};
    const auto after = beyond(a, c);
    if (after == no_node) return sum;
    for (auto& [node, weight] : sum)
      weight *= 2.0;
    add(sum, inner_slope(after, a, c), 1.0); // that at a, towards c
    return sum;
  }

  /// Mean of the mixed derivatives at c, along the ways to u and v, of the facets that meet there in a grid.
  Combination twist(std::int32_t c, std::int32_t u, std::int32_t v) const {
    Combination sum;
    int count = 0;
    const std::array<std::int32_t, 2> along_u = {u, beyond(c, u)}, along_v = {v, beyond(c, v)};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const auto corner =
            along_u[i] == no_node || along_v[j] == no_node ? no_node : fourth(c, along_u[i], along_v[j]);
        if (corner == no_node) continue;
        add(sum, {{c, 1.0}, {along_u[i], -1.0}, {along_v[j], -1.0}, {corner, 1.0}}, i == j ? 1.0 : -1.0);
        ++count;
      }
    for (auto& [node, weight] : sum)
      weight /= count;
    return sum;
  }

 private:
  Eigen::Vector3d place(std::int32_t node) const {
    const auto facet = surface_.facets_at(node)[0];
    const auto nodes = surface_.nodes(facet);
    const auto a = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    for (int c = 0; c < dim_; ++c)
      result[c] = surface_.reference_positions(facet)[a * dim_ + c];
    return result;
  }

  double length(std::int32_t a, std::int32_t b) const { return dim_ == 2 ? (place(a) - place(b)).norm() : 1.0; }

  std::int32_t across(std::int32_t c, std::int32_t a) const {
    std::int32_t found = no_node;
    for (const auto facet : surface_.facets_at(c)) {
      const auto nodes = surface_.nodes(facet);
      if (std::find(nodes.begin(), nodes.end(), a) != nodes.end()) continue;
      const std::size_t n = nodes.size(), at = std::find(nodes.begin(), nodes.end(), c) - nodes.begin();
      for (const auto node : {nodes[(at + 1) % n], nodes[(at + n - 1) % n]}) {
        if (node == found || share_a_facet(c, node, a)) continue;
        if (found != no_node) return no_node; // not a grid
        found = node;
      }
    }
    return found;
  }

  bool share_a_facet(std::int32_t c, std::int32_t a, std::int32_t b) const {
    const auto facets = surface_.facets_at(c);
    return std::any_of(facets.begin(), facets.end(), [&](std::int32_t facet) {
      const auto nodes = surface_.nodes(facet);
      return std::find(nodes.begin(), nodes.end(), a) != nodes.end() &&
             std::find(nodes.begin(), nodes.end(), b) != nodes.end();
    });
  }

  /// The corner opposite to c of the quadrilateral with these three; or none.
  std::int32_t fourth(std::int32_t c, std::int32_t u, std::int32_t v) const {
    for (const auto facet : surface_.facets_at(c)) {
      const auto nodes = surface_.nodes(facet);
      const std::size_t at = std::find(nodes.begin(), nodes.end(), c) - nodes.begin();
      const auto next = nodes[(at + 1) % 4], last = nodes[(at + 3) % 4];
      if ((next == u && last == v) || (next == v && last == u)) return nodes[(at + 2) % 4];
    }
    return no_node;
  }

  /// That of the parabola through a', c, a, at c.
  Combination inner_slope(std::int32_t before, std::int32_t c, std::int32_t a) const {
    const double h0 = length(c, before), h = length(c, a);
    return {{before, -h * h / (h0 * (h0 + h))}, {c, (h - h0) / h0}, {a, h0 / (h0 + h)}};
  }

  const MasterSurface& surface_;
  int dim_;
  double cosine_;
};

std::vector<Combination> control_of_segment(const Lines& lines, std::span<const std::int32_t> nodes) {
  std::vector<Combination> control = {{{nodes[0], 1.0}}, {{nodes[0], 1.0}}, {{nodes[1], 1.0}}, {{nodes[1], 1.0}}};
  add(control[1], lines.slope(nodes[0], nodes[1]), 1.0 / 3.0);
  add(control[2], lines.slope(nodes[1], nodes[0]), 1.0 / 3.0);
  return control;
}

std::vector<Combination> control_of_quadrilateral(const Lines& lines, std::span<const std::int32_t> nodes) {
  std::vector<Combination> control(16);
  for (int k = 0; k < 4; ++k) {
    const bool right = k == 1 || k == 2, top = k >= 2;
    const auto c = nodes[k], u = nodes[(right == top ? k + 1 : k + 3) % 4],
               v = nodes[(right == top ? k + 3 : k + 1) % 4];
    const int corner = (right ? 3 : 0) + 4 * (top ? 3 : 0), du = right ? -1 : 1, dv = top ? -4 : 4;
    const auto along_u = lines.slope(c, u), along_v = lines.slope(c, v);
    for (const int at : {corner, corner + du, corner + dv, corner + du + dv})
      control[at][c] += 1.0;
    for (const int at : {corner + du, corner + du + dv})
      add(control[at], along_u, 1.0 / 3.0);
    for (const int at : {corner + dv, corner + du + dv})
      add(control[at], along_v, 1.0 / 3.0);
    add(control[corner + du + dv], lines.twist(c, u, v), 1.0 / 9.0);
  }
  return control;
}

} // namespace

SmoothMaster::SmoothMaster(const MasterSurface& surface, const CubicMaster& smoothing)
    : dim_(surface.dim()), facets_(surface.num_facets()) {
  const Lines lines(surface, dim_, smoothing.crease_angle * std::numbers::pi / 180.0);
  for (std::int32_t f = 0; f < surface.num_facets(); ++f) {
    const auto nodes = surface.nodes(f);
    const auto type = surface.type(f);
    if (type != ElementType::Segment2 && type != ElementType::Quadrilateral4)
      throw std::logic_error("contact: only segments and bilinear quadrilaterals can be smoothed");
    const auto control = dim_ == 2 ? control_of_segment(lines, nodes) : control_of_quadrilateral(lines, nodes);
    auto& stencil = facets_[f].stencil;
    stencil.assign(nodes.begin(), nodes.end());
    for (const auto& combination : control)
      for (const auto& [node, weight] : combination)
        if (std::find(stencil.begin(), stencil.end(), node) == stencil.end()) stencil.push_back(node);
    auto& weights = facets_[f].weights;
    weights.setZero(static_cast<Eigen::Index>(control.size()), static_cast<Eigen::Index>(stencil.size()));
    for (std::size_t k = 0; k < control.size(); ++k)
      for (std::size_t a = 0; a < stencil.size(); ++a)
        if (const auto found = control[k].find(stencil[a]); found != control[k].end())
          weights(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(a)) = found->second;
    facets_[f].control.assign(control.size() * dim_, 0.0);
  }
}

BernsteinTable SmoothMaster::shape_table(std::int32_t facet, std::span<const double> xi) const {
  return bernstein_table(dim_, xi) * facets_[facet].weights;
}

void SmoothMaster::move(std::span<const double> places) {
  for (auto& facet : facets_) {
    std::fill(facet.control.begin(), facet.control.end(), 0.0);
    for (Eigen::Index k = 0; k < facet.weights.rows(); ++k)
      for (std::size_t a = 0; a < facet.stencil.size(); ++a)
        for (int c = 0; c < dim_; ++c)
          facet.control[k * dim_ + c] +=
              facet.weights(k, static_cast<Eigen::Index>(a)) * places[std::size_t(facet.stencil[a]) * dim_ + c];
  }
}

} // namespace amontons
