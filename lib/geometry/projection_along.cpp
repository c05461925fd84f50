#include "geometry/facet_map.hpp"
#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace amontons {

namespace {

using facet::Xi;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Real roots of k0 + k1 s + k2 s² = 0 without cancellation; `count` of them. A coefficient counts as zero when it is
/// below rounding of `scale`, the size of the terms it was summed from.
struct Roots {
  std::array<double, 2> s{};
  int count = 0;
};

Roots quadratic_roots(double k0, double k1, double k2, double scale) {
  const double zero = 1e-14 * scale;
  if (std::abs(k2) <= zero) {
    if (std::abs(k1) <= zero) return {};
    return {{-k0 / k1, 0.0}, 1};
  }
  const double discriminant = k1 * k1 - 4.0 * k0 * k2;
  if (discriminant < 0.0) return {};
  const double q = -0.5 * (k1 + std::copysign(std::sqrt(discriminant), k1));
  if (q == 0.0) return {{0.0, 0.0}, 1};
  return {{q / k2, k0 / q}, 2};
}

/// The facet's nodes seen along the line: coordinates across the direction, relative to x. The line meets the facet
/// where Σ N_a(ξ) p_a = 0.
struct View {
  ElementType type;
  std::array<Eigen::Vector2d, 9> p;
  double size = 0.0; // largest distance of a node from node 0
};

View view_along(const facet::Surface& surface, const Eigen::Vector3d& x, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::Vector3d first = d.unitOrthogonal(), second = d.cross(first);
  View view{surface.type, {}, 0.0};
  for (int i = 0; i < num_nodes(surface.type); ++i) {
    const Eigen::Vector3d r = surface.node(i) - x;
    view.p[i] = {first.dot(r), second.dot(r)};
    view.size = std::max(view.size, (surface.node(i) - surface.node(0)).norm());
  }
  return view;
}

/// Straight triangle: p0 + ξ (p1 - p0) + η (p2 - p0) = 0 by Cramer's rule.
void meet_triangle(const View& view, std::vector<Xi>& found) {
  const Eigen::Vector2d first = view.p[1] - view.p[0], second = view.p[2] - view.p[0];
  const double determinant = cross(first, second);
  if (std::abs(determinant) <= 1e-14 * view.size * view.size) return;
  found.emplace_back(-cross(view.p[0], second) / determinant, -cross(first, view.p[0]) / determinant);
}

/// Bilinear quadrilateral: A + B ξ + C η + D ξη = 0. The cross product with C + D ξ leaves a quadratic in ξ,
///   A×C + (A×D + B×C) ξ + B×D ξ² = 0,   and   η = -(A + B ξ)·(C + D ξ) / |C + D ξ|².
void meet_quadrilateral(const View& view, std::vector<Xi>& found) {
  const auto& p = view.p;
  const Eigen::Vector2d A = 0.25 * (p[0] + p[1] + p[2] + p[3]), B = 0.25 * (-p[0] + p[1] + p[2] - p[3]);
  const Eigen::Vector2d C = 0.25 * (-p[0] - p[1] + p[2] + p[3]), D = 0.25 * (p[0] - p[1] + p[2] - p[3]);
  const Roots roots = quadratic_roots(cross(A, C), cross(A, D) + cross(B, C), cross(B, D), view.size * view.size);
  for (int i = 0; i < roots.count; ++i) {
    const double xi = roots.s[i];
    const Eigen::Vector2d across = C + xi * D;
    const double length2 = across.squaredNorm();
    if (length2 <= 1e-28 * view.size * view.size) continue;
    found.emplace_back(xi, -(A + xi * B).dot(across) / length2);
  }
}

/// Curved facet: Newton's method from the samples of the cell.
void meet_curved(const View& view, std::vector<Xi>& found) {
  std::array<double, 9> values;
  std::array<double, 18> gradients;
  const int count = num_nodes(view.type);
  for (Xi xi : facet::starts(view.type)) {
    for (int iteration = 0; iteration < 30; ++iteration) {
      shape_values(view.type, std::span(xi.data(), 2), std::span(values).first(count));
      shape_gradients(view.type, std::span(xi.data(), 2), std::span(gradients).first(2 * std::size_t(count)));
      Eigen::Vector2d residual = Eigen::Vector2d::Zero();
      Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
      for (int a = 0; a < count; ++a) {
        residual += values[a] * view.p[a];
        jacobian.col(0) += gradients[2 * a] * view.p[a];
        jacobian.col(1) += gradients[2 * a + 1] * view.p[a];
      }
      const double determinant = jacobian.determinant();
      if (std::abs(determinant) <= 1e-14 * view.size * view.size) break;
      const Xi step = -jacobian.inverse() * residual;
      xi += step;
      if (!(facet::outside(view.type, xi) < 2.0)) break; // far outside: not going to come back
      if (step.lpNorm<Eigen::Infinity>() > 1e-13) continue;
      const auto same = [&](const Xi& other) { return (other - xi).lpNorm<Eigen::Infinity>() < 1e-9; };
      if (std::none_of(found.begin(), found.end(), same)) found.push_back(xi);
      break;
    }
  }
}

/// Segment, straight or curved: (ρ(s) - x) × d = 0 is a quadratic in s.
Projection meet_segment(ElementType type, std::span<const double> nodes, std::span<const double> x,
                        std::span<const double> direction, double tolerance) {
  const Eigen::Vector2d position(x[0], x[1]), d = Eigen::Vector2d(direction[0], direction[1]).normalized();
  const facet::Curve<2> curve = facet::segment_curve(type, nodes);
  const Roots roots = quadratic_roots(cross(curve.a - position, d), cross(curve.b, d), cross(curve.c, d),
                                      curve.b.norm() + curve.c.norm());
  Projection best;
  for (int i = 0; i < roots.count; ++i) {
    if (std::abs(roots.s[i]) > 1.0 + tolerance) continue;
    const Xi xi(std::clamp(roots.s[i], -1.0, 1.0), 0.0);
    const Projection next = facet::landed(type, nodes, x, xi);
    if (next.found && (!best.found || next.distance < best.distance)) best = next;
  }
  return best;
}

} // namespace

Projection project_along(ElementType type, std::span<const double> nodes, std::span<const double> x,
                         std::span<const double> direction, double tolerance) {
  if (element_dim(type) == 1) return meet_segment(type, nodes, x, direction, tolerance);
  const facet::Surface surface{type, nodes};
  const View view =
      view_along(surface, Eigen::Vector3d(x[0], x[1], x[2]), Eigen::Vector3d(direction[0], direction[1], direction[2]));
  std::vector<Xi> meetings;
  if (type == ElementType::Triangle3)
    meet_triangle(view, meetings);
  else if (type == ElementType::Quadrilateral4)
    meet_quadrilateral(view, meetings);
  else
    meet_curved(view, meetings);
  Projection best;
  for (const Xi& meeting : meetings) {
    if (!(facet::outside(type, meeting) <= tolerance)) continue;
    const Projection next = facet::landed(type, nodes, x, facet::clamped(type, meeting));
    if (next.found && (!best.found || next.distance < best.distance)) best = next;
  }
  return best;
}

} // namespace amontons
