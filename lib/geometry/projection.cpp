#include "geometry/projection.hpp"

#include "geometry/facet_map.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace amontons {

namespace {

using facet::Curve;
using facet::Surface;
using facet::Xi;

// --- curves: segments, and edges of surface facets ----------------------------------------------------------------

/// k0 + k1 s + k2 s² + k3 s³.
struct Cubic {
  std::array<double, 4> k;
  double value(double s) const { return k[0] + s * (k[1] + s * (k[2] + s * k[3])); }
  double slope(double s) const { return k[1] + s * (2.0 * k[2] + s * 3.0 * k[3]); }
};

/// The root in [low, high] of a cubic that rises from a negative to a positive value there: Newton's method, replaced
/// by bisection where it leaves the bracket.
double bracketed_root(const Cubic& cubic, double low, double high) {
  double s = 0.5 * (low + high);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double value = cubic.value(s);
    (value > 0.0 ? high : low) = s;
    double next = s - value / cubic.slope(s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-16) return next;
    s = next;
  }
  return s;
}

/// Position s in [-1, 1] of the point of a curve that is closest to x. With e = a - x half the squared distance has the
/// derivative
///   (ρ - x)·ρ' = e·b + (b·b + 2 e·c) s + 3 b·c s² + 2 c·c s³,
/// whose rising roots are bracketed by its own extrema, so that the minimum found is the global one.
template <int dim>
double closest_on_curve(const Curve<dim>& curve, const Point<dim>& x) {
  const Point<dim> e = curve.a - x;
  if (curve.c.isZero(0.0)) {
    const double length2 = curve.b.squaredNorm();
    return length2 > 0.0 ? std::clamp(-e.dot(curve.b) / length2, -1.0, 1.0) : 0.0;
  }
  const Cubic slope{{e.dot(curve.b), curve.b.squaredNorm() + 2.0 * e.dot(curve.c), 3.0 * curve.b.dot(curve.c),
                     2.0 * curve.c.squaredNorm()}};
  std::array<double, 4> ends{-1.0, -1.0, 1.0, 1.0};
  // Extrema of the slope: k1 + 2 k2 s + 3 k3 s² = 0, k3 > 0.
  const double discriminant = slope.k[2] * slope.k[2] - 3.0 * slope.k[3] * slope.k[1];
  if (discriminant > 0.0) {
    const double q = -(slope.k[2] + std::copysign(std::sqrt(discriminant), slope.k[2]));
    const double first = q / (3.0 * slope.k[3]), second = slope.k[1] / q;
    ends[1] = std::clamp(std::min(first, second), -1.0, 1.0);
    ends[2] = std::clamp(std::max(first, second), -1.0, 1.0);
  }
  // Half the squared distance less its value at s = 0: no cancellation when x is far away.
  const auto distance = [&](double s) {
    const Point<dim> r = s * (curve.b + s * curve.c);
    return 0.5 * r.squaredNorm() + r.dot(e);
  };
  double best = distance(-1.0) <= distance(1.0) ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(slope.value(ends[i]) < 0.0 && slope.value(ends[i + 1]) > 0.0)) continue;
    const double s = bracketed_root(slope, ends[i], ends[i + 1]);
    if (distance(s) < distance(best)) best = s;
  }
  return best;
}

// --- surfaces -----------------------------------------------------------------------------------------------------

/// Half the squared distance from x to ρ(ξ), less a constant: differences stay accurate when x is far away.
double reduced_distance(const Surface& surface, const Eigen::Vector3d& x, const Xi& xi) {
  const Eigen::Vector3d r = surface.position(xi) - surface.node(0);
  return 0.5 * r.squaredNorm() - r.dot(x - surface.node(0));
}

/// Is ρ(a) closer to x than ρ(b)? |ρa - x|² - |ρb - x|² = (ρa - ρb)·((ρa - x) + (ρb - x)) without cancellation.
bool is_closer(const Surface& surface, const Eigen::Vector3d& x, const Xi& a, const Xi& b) {
  const Eigen::Vector3d first = surface.position(a), second = surface.position(b);
  return (first - second).dot((first - x) + (second - x)) < 0.0;
}

/// Gradient and Hessian of half the squared distance with respect to ξ.
struct Slope {
  Eigen::Vector2d gradient;
  Eigen::Matrix2d hessian;
  Eigen::Matrix2d metric; // ∂ρ/∂ξ_a · ∂ρ/∂ξ_b
};

Slope slope_at(const Surface& surface, const Eigen::Vector3d& x, const Xi& xi) {
  const Eigen::Vector3d r = surface.position(xi) - x;
  const facet::Tangents tangents = surface.tangents(xi);
  Slope slope;
  slope.gradient = tangents.transpose() * r;
  slope.metric = tangents.transpose() * tangents;
  const Eigen::Vector3d bending = surface.second_derivatives(xi).transpose() * r;
  slope.hessian = slope.metric;
  slope.hessian(0, 0) += bending[0];
  slope.hessian(0, 1) += bending[1];
  slope.hessian(1, 0) += bending[1];
  slope.hessian(1, 1) += bending[2];
  return slope;
}

/// -|H|⁻¹ g with the absolute values of the Hessian's eigenvalues: Newton's step where the Hessian is positive
/// definite, a descent direction everywhere.
Xi descent_step(const Slope& slope) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(slope.hessian);
  const double floor = 1e-8 * slope.metric.trace() + std::numeric_limits<double>::min();
  const Eigen::Vector2d eigenvalues = solver.eigenvalues().cwiseAbs().cwiseMax(floor);
  const Eigen::Matrix2d& vectors = solver.eigenvectors();
  return -vectors * (vectors.transpose() * slope.gradient).cwiseQuotient(eigenvalues);
}

/// Damped Newton descent inside the cell to a stationary point; nothing when the border stops it. It does not from a
/// start whose distance is below that of every border point, because the iterates only come closer.
std::optional<Xi> descend(const Surface& surface, const Eigen::Vector3d& x, Xi xi) {
  double distance = reduced_distance(surface, x, xi);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Slope slope = slope_at(surface, x, xi);
    const Xi step = descent_step(slope);
    if (step.lpNorm<Eigen::Infinity>() <= 1e-14) return xi;
    // Close to the minimum the distance no longer resolves the progress, and Newton's step needs no guard.
    if (step.lpNorm<Eigen::Infinity>() <= 1e-6 && facet::outside(surface.type, xi + step) <= 0.0) {
      xi += step;
      distance = reduced_distance(surface, x, xi);
      continue;
    }
    double length = 1.0;
    for (; length > 1e-14; length *= 0.5) {
      const Xi trial = xi + length * step;
      if (facet::outside(surface.type, trial) > 0.0) continue;
      const double trial_distance = reduced_distance(surface, x, trial);
      if (trial_distance > distance + 1e-4 * length * slope.gradient.dot(step)) continue;
      xi = trial;
      distance = trial_distance;
      break;
    }
    if (length <= 1e-14) return std::nullopt;
  }
  // Slow convergence (x at a centre of curvature): where the slope has died down the distance is right to rounding.
  const Slope slope = slope_at(surface, x, xi);
  const double scale = std::sqrt(slope.metric.trace()) * (surface.position(xi) - x).norm() + slope.metric.trace();
  return slope.gradient.norm() <= 1e-7 * scale ? std::optional(xi) : std::nullopt;
}

/// ξ of the point closest to x on the whole border of the facet: the global minimum over all edges.
Xi closest_on_border(const Surface& surface, const Eigen::Vector3d& x) {
  const int corners = num_vertices(surface.type);
  const bool curved = element_order(surface.type) == 2;
  const std::span<const double> reference = reference_nodes(surface.type);
  const auto corner = [&](int i) { return Xi(reference[2 * i], reference[2 * i + 1]); };
  Xi best = Xi::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < corners; ++i) {
    const int j = (i + 1) % corners;
    Eigen::Vector3d middle;
    if (curved) middle = surface.node(corners + i); // gmsh: edge nodes follow the corners, edge by edge
    const auto curve = facet::curve_through<3>(surface.node(i), surface.node(j), curved ? &middle : nullptr);
    const double s = closest_on_curve<3>(curve, x);
    const double distance = (curve.position(s) - x).squaredNorm();
    if (distance < least) {
      least = distance;
      best = facet::clamped(surface.type, 0.5 * (1.0 - s) * corner(i) + 0.5 * (1.0 + s) * corner(j));
    }
  }
  return best;
}

/// From the closest border point, a point inside that is closer still; nothing when the distance does not fall inwards.
/// (At a border minimum the gradient is normal to the edge; a vertex that is the minimum of both its edges is the
/// minimum of the corner.)
std::optional<Xi> step_inwards(const Surface& surface, const Eigen::Vector3d& x, const Xi& border) {
  const Slope slope = slope_at(surface, x, border);
  const double scale = slope.metric.trace() + std::sqrt(slope.metric.trace()) * (surface.position(border) - x).norm();
  if (slope.gradient.norm() <= 1e-14 * scale) return std::nullopt;
  const double bending = slope.gradient.dot(slope.metric * slope.gradient);
  Xi step = -slope.gradient * (slope.gradient.squaredNorm() / bending);
  if (step.lpNorm<Eigen::Infinity>() > 0.5) step *= 0.5 / step.lpNorm<Eigen::Infinity>();
  if (facet::outside(surface.type, border + 1e-3 * step) > 0.0) return std::nullopt;
  const double distance = reduced_distance(surface, x, border);
  for (double length = 1.0; length > 1e-12; length *= 0.5) {
    const Xi trial = border + length * step;
    if (facet::outside(surface.type, trial) <= 0.0 && reduced_distance(surface, x, trial) < distance) return trial;
  }
  return std::nullopt;
}

/// Where descents start: the samples inside the cell that are closest to x, of those near to each other only the first.
/// On a bilinear facet one that is closer than `border` is enough; a curved one may have several minima, and a descent
/// from farther away may still end below the border.
std::vector<Xi> sampled_starts(const Surface& surface, const Eigen::Vector3d& x, double border) {
  const bool curved = element_order(surface.type) == 2;
  std::vector<std::pair<double, Xi>> samples;
  for (const Xi& xi : facet::starts(surface.type)) {
    const double distance = reduced_distance(surface, x, xi);
    if (curved || distance < border) samples.emplace_back(distance, xi);
  }
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::size_t most = curved ? 4 : 1;
  const double apart = facet::is_triangle(surface.type) ? 0.2 : 0.4;
  std::vector<Xi> chosen;
  for (const auto& [distance, xi] : samples) {
    if (chosen.size() == most) break;
    const auto near = [&, &place = xi](const Xi& other) { return (place - other).norm() < apart; };
    if (std::none_of(chosen.begin(), chosen.end(), near)) chosen.push_back(xi);
  }
  return chosen;
}

/// Is half the squared distance from x certainly convex on the whole reference cell? Then it has one minimum. Lower
/// bounds, with |ξ| <= 1, of the Hessian's diagonal ρ_a · ρ_a + (ρ − x) · ρ_aa, and an upper one of what is beside it,
/// from the coefficients of ρ. No for strongly curved facets, and for x beyond their centre of curvature.
bool is_surely_convex(const Surface& surface, const Eigen::Vector3d& x) {
  const auto& k = surface.k;
  const Eigen::Vector3d r = k[0][0] - x;
  // Size of ρ − x along v.
  const auto along = [&](const Eigen::Vector3d& v) {
    double sum = -std::abs(r.dot(v));
    for (const auto& row : k)
      for (const Eigen::Vector3d& term : row)
        sum += std::abs((&term == &k[0][0] ? r : term).dot(v));
    return std::array{r.dot(v) - sum, std::abs(r.dot(v)) + sum}; // least, largest absolute
  };
  double far = 0.0;
  for (const auto& row : k)
    for (const Eigen::Vector3d& term : row)
      far += (&term == &k[0][0] ? r : term).norm();
  // ∂ρ/∂ξ_a = first[a] + parts of these sizes.
  const std::array first{k[1][0], k[0][1]};
  const std::array<std::array<Eigen::Vector3d, 5>, 2> rest{
      {{k[1][1], k[1][2], 2.0 * k[2][0], 2.0 * k[2][1], 2.0 * k[2][2]},
       {k[1][1], k[2][1], 2.0 * k[0][2], 2.0 * k[1][2], 2.0 * k[2][2]}}};
  const std::array<std::array<double, 2>, 2> bends{
      {{2.0 * along(k[2][0])[0], 2.0 * (k[2][1].norm() + k[2][2].norm())},
       {2.0 * along(k[0][2])[0], 2.0 * (k[1][2].norm() + k[2][2].norm())}}};
  std::array<double, 2> diagonal{}, size{};
  for (std::size_t a = 0; a < 2; ++a) {
    diagonal[a] = first[a].squaredNorm() + bends[a][0] - far * bends[a][1];
    for (const Eigen::Vector3d& part : rest[a]) {
      diagonal[a] -= 2.0 * std::abs(first[a].dot(part));
      size[a] += part.norm();
    }
  }
  double beside = std::abs(first[0].dot(first[1])) + size[0] * size[1] + along(k[1][1])[1] +
                  2.0 * far * (k[2][1].norm() + k[1][2].norm() + 2.0 * k[2][2].norm());
  for (std::size_t a = 0; a < 2; ++a)
    for (const Eigen::Vector3d& part : rest[1 - a])
      beside += std::abs(first[a].dot(part));
  return diagonal[0] > 0.0 && diagonal[1] > 0.0 && diagonal[0] * diagonal[1] > beside * beside;
}

/// The minimum of the distance over a curved facet: that of the border, unless a descent from the border or from
/// samples inside ends at a closer point. Nothing when there are closer points but every descent failed.
std::optional<Xi> closest_on_curved(const Surface& surface, const Eigen::Vector3d& x) {
  const Xi border = closest_on_border(surface, x);
  const std::optional<Xi> inwards = step_inwards(surface, x, border);
  if (is_surely_convex(surface, x)) {
    if (!inwards) return border;
    if (const std::optional<Xi> end = descend(surface, x, *inwards)) return end;
  }
  const double border_distance = reduced_distance(surface, x, border);
  std::vector<Xi> starts = sampled_starts(surface, x, border_distance);
  if (inwards) starts.push_back(*inwards);
  const double rounding = 1e-13 * surface.extent() * (surface.extent() + (surface.position(border) - x).norm());
  Xi best = border;
  bool is_lost = false, is_replaced = false;
  for (const Xi& start : starts) {
    const std::optional<Xi> end = descend(surface, x, start);
    if (!end) is_lost = is_lost || reduced_distance(surface, x, start) < border_distance - rounding;
    if (!end || !is_closer(surface, x, *end, best)) continue;
    best = *end;
    is_replaced = true;
  }
  if (is_lost && !is_replaced) return std::nullopt;
  return best;
}

/// A straight triangle: the foot of the perpendicular when it lies inside, else the closest point of the border.
Xi closest_on_triangle(const Surface& surface, const Eigen::Vector3d& x) {
  const Eigen::Vector3d first = surface.node(1) - surface.node(0), second = surface.node(2) - surface.node(0);
  const Eigen::Vector3d r = x - surface.node(0), n = first.cross(second);
  const double area2 = n.squaredNorm();
  if (area2 > 0.0) {
    const Xi xi(r.cross(second).dot(n) / area2, first.cross(r).dot(n) / area2);
    if (facet::outside(surface.type, xi) <= 0.0) return xi;
  }
  return closest_on_border(surface, x);
}

} // namespace

double facet_normal(ElementType type, std::span<const double> nodes, std::span<const double> xi,
                    std::array<double, 3>& normal) {
  Eigen::Vector3d area;
  if (element_dim(type) == 1) {
    const Point<2> tangent = facet::segment_curve(type, nodes).tangent(xi[0]);
    area = {tangent[1], -tangent[0], 0.0};
  } else {
    const facet::Tangents tangents = Surface{type, nodes}.tangents(Xi(xi[0], xi[1]));
    area = tangents.col(0).cross(tangents.col(1));
  }
  const double measure = area.norm();
  if (measure > 0.0) area /= measure;
  normal = {area[0], area[1], area[2]};
  return measure;
}

Projection closest_point(ElementType type, std::span<const double> nodes, std::span<const double> x) {
  if (element_order(type) == 2 && facet::is_straight(type, nodes)) {
    const auto linear = linear_element(type); // the same ξ at the same place, in a tenth of the time
    return closest_point(linear, nodes.first(std::size_t(num_nodes(linear)) * (element_dim(type) + 1)), x);
  }
  if (element_dim(type) == 1) {
    const double s = closest_on_curve<2>(facet::segment_curve(type, nodes), Point<2>(x[0], x[1]));
    return facet::landed(type, nodes, x, Xi(s, 0.0));
  }
  const Surface surface{type, nodes};
  const Eigen::Vector3d position(x[0], x[1], x[2]);
  if (type == ElementType::Triangle3) return facet::landed(type, nodes, x, closest_on_triangle(surface, position));
  const std::optional<Xi> xi = closest_on_curved(surface, position);
  return xi ? facet::landed(type, nodes, x, *xi) : Projection{};
}

double facet_size(ElementType type, std::span<const double> nodes) {
  if (element_dim(type) == 1) return std::hypot(nodes[2] - nodes[0], nodes[3] - nodes[1]);
  const Surface surface{type, nodes};
  // Twice the area of a triangle; of a quadrilateral (also warped, then of its projection) half the product of
  // diagonals.
  if (facet::is_triangle(type))
    return std::sqrt((surface.node(1) - surface.node(0)).cross(surface.node(2) - surface.node(0)).norm());
  return std::sqrt(0.5 * (surface.node(2) - surface.node(0)).cross(surface.node(3) - surface.node(1)).norm());
}

} // namespace amontons
