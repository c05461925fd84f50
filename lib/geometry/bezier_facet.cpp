// In 2D both projections are roots of polynomials in ξ: of (ρ − x) · ρ', of degree 5, and of (ρ − x) × d, of degree 3.
// The roots of a polynomial are bracketed by those of its derivative, so all of them are found, degree by degree. In 3D
// they are found by Newton's method.
#include "geometry/bezier_facet.hpp"

#include "math/element_type.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace amontons {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Within this of the border of the reference cell a point is on it.
constexpr double on_border = 1e-12;

/// Bernstein polynomials of degree 3 in (1 + s) / 2 (row 0), first and second derivatives by s.
Eigen::Matrix<double, 3, 4> bernstein(double s) {
  const double t = 0.5 * (1.0 + s), r = 0.5 * (1.0 - s);
  Eigen::Matrix<double, 3, 4> table;
  table << r * r * r, 3.0 * r * r * t, 3.0 * r * t * t, t * t * t,                         //
      -1.5 * r * r, 1.5 * (r * r - 2.0 * r * t), 1.5 * (2.0 * r * t - t * t), 1.5 * t * t, //
      1.5 * r, 1.5 * (t - 2.0 * r), 1.5 * (r - 2.0 * t), 1.5 * t;
  return table;
}

Vector3d padded(std::span<const double> x) { return {x[0], x[1], x.size() > 2 ? x[2] : 0.0}; }

/// The projection of x that landed on ξ.
Projection landed(const BezierFacet& facet, const Vector3d& x, const std::array<double, 2>& xi) {
  const auto at = surface_point(facet, xi);
  Projection result;
  result.xi = xi;
  int touched = 0;
  for (int k = 0; k < facet.dim - 1; ++k)
    touched += 1.0 - std::abs(xi[k]) <= on_border;
  result.feature = touched == 0 ? Feature::Facet : touched == facet.dim - 1 ? Feature::Vertex : Feature::Edge;
  const Vector3d across = at.tangents.col(0).cross(at.tangents.col(1));
  const double size = at.tangents.col(0).norm() * at.tangents.col(1).norm();
  Vector3d::Map(result.point.data()) = at.place;
  Vector3d::Map(result.normal.data()) = across.normalized();
  result.distance = (x - at.place).norm();
  result.found = across.norm() > 1e-12 * size;
  return result;
}

// --- 2D: polynomials -------------------------------------------------------------------------------------------------

double value_of(std::span<const double> k, double s) {
  double value = 0.0;
  for (std::size_t i = k.size(); i-- > 0;)
    value = value * s + k[i];
  return value;
}

/// Root between two places where the polynomial has values of different signs: Newton's method, or bisection where it
/// leaves the bracket.
double bracketed_root(std::span<const double> k, std::span<const double> slope, double low, double high) {
  const bool rises = value_of(k, low) < 0.0;
  double s = 0.5 * (low + high);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double value = value_of(k, s);
    (rises == (value > 0.0) ? high : low) = s;
    double next = s - value / value_of(slope, s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-16) return next;
    s = next;
  }
  return s;
}

/// Where Σ k_i s^i changes its sign in [low, high], ascending.
std::vector<double> roots(std::span<const double> k, double low, double high) {
  if (k.size() < 2) return {};
  std::vector<double> slope;
  for (std::size_t i = 1; i < k.size(); ++i)
    slope.push_back(double(i) * k[i]);
  std::vector<double> ends = {low}, found;
  for (const double extremum : roots(slope, low, high))
    ends.push_back(extremum);
  ends.push_back(high);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double first = value_of(k, ends[i]), last = value_of(k, ends[i + 1]);
    if (first == 0.0)
      found.push_back(ends[i]);
    else if (first * last < 0.0)
      found.push_back(bracketed_root(k, slope, ends[i], ends[i + 1]));
  }
  if (value_of(k, high) == 0.0) found.push_back(high);
  return found;
}

/// Columns c_i of ρ = Σ c_i s^i.
Eigen::Matrix<double, 2, 4> powers(const BezierFacet& facet) {
  const auto c = [&](int k) { return Vector2d(facet.control[2 * k], facet.control[2 * k + 1]); };
  Eigen::Matrix<double, 2, 4> p;
  p.col(0) = 0.125 * (c(0) + 3.0 * c(1) + 3.0 * c(2) + c(3));
  p.col(1) = 0.375 * (c(3) + c(2) - c(1) - c(0));
  p.col(2) = 0.375 * (c(0) - c(1) - c(2) + c(3));
  p.col(3) = 0.125 * (c(3) - c(0) + 3.0 * (c(1) - c(2)));
  return p;
}

Projection closest_on_curve(const BezierFacet& facet, std::span<const double> x) {
  auto p = powers(facet);
  p.col(0) -= Vector2d(x[0], x[1]);
  std::array<double, 6> slope{};
  for (int i = 0; i < 4; ++i)
    for (int j = 1; j < 4; ++j)
      slope[i + j - 1] += j * p.col(i).dot(p.col(j));
  std::vector<double> places = roots(slope, -1.0, 1.0);
  places.insert(places.end(), {-1.0, 1.0});
  // Squared distance less that at s = 0: no cancellation when x is far away.
  const auto distance = [&](double s) {
    const Vector2d r = s * (p.col(1) + s * (p.col(2) + s * p.col(3)));
    return r.squaredNorm() + 2.0 * r.dot(p.col(0));
  };
  const double best =
      *std::min_element(places.begin(), places.end(), [&](double a, double b) { return distance(a) < distance(b); });
  return landed(facet, padded(x), {best, 0.0});
}

Projection meet_curve(const BezierFacet& facet, std::span<const double> x, std::span<const double> direction,
                      double tolerance) {
  const auto p = powers(facet);
  const Vector2d across = Vector2d(direction[1], -direction[0]).normalized();
  std::array<double, 4> k{};
  for (int i = 0; i < 4; ++i)
    k[i] = across.dot(p.col(i));
  k[0] -= across.dot(Vector2d(x[0], x[1]));
  Projection best;
  for (const double s : roots(k, -1.0 - tolerance, 1.0 + tolerance)) {
    const auto next = landed(facet, padded(x), {std::clamp(s, -1.0, 1.0), 0.0});
    if (next.found && (!best.found || next.distance < best.distance)) best = next;
  }
  return best;
}

// --- 3D: Newton's method ---------------------------------------------------------------------------------------------

/// Gradient and Hessian of half the squared distance.
struct Slope {
  double distance;
  Vector2d gradient;
  Eigen::Matrix2d hessian;
};

Slope slope_at(const BezierFacet& facet, const Vector3d& x, const Vector2d& xi) {
  const auto at = surface_point(facet, std::span(xi.data(), 2));
  const Vector3d r = at.place - x, bend = at.second.transpose() * r;
  Slope slope{0.5 * r.squaredNorm(), at.tangents.transpose() * r, at.tangents.transpose() * at.tangents};
  slope.hessian(0, 0) += bend[0];
  slope.hessian(0, 1) += bend[1];
  slope.hessian(1, 0) += bend[1];
  slope.hessian(1, 1) += bend[2];
  return slope;
}

/// Newton's step with the absolute eigenvalues of the Hessian (a descent, everywhere) in the directions that the border
/// leaves free.
Vector2d descent_step(const Slope& slope, const Vector2d& xi) {
  Vector2d gradient = slope.gradient;
  Eigen::Matrix2d hessian = slope.hessian;
  for (int k = 0; k < 2; ++k) {
    const bool is_held = (xi[k] >= 1.0 && gradient[k] < 0.0) || (xi[k] <= -1.0 && gradient[k] > 0.0);
    if (!is_held) continue;
    gradient[k] = 0.0;
    hessian(0, 1) = hessian(1, 0) = 0.0;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(hessian);
  const double floor = 1e-10 * slope.hessian.norm() + std::numeric_limits<double>::min();
  const Vector2d curvature = solver.eigenvalues().cwiseAbs().cwiseMax(floor);
  return -solver.eigenvectors() * (solver.eigenvectors().transpose() * gradient).cwiseQuotient(curvature);
}

/// Samples of the cell, in one direction.
constexpr std::array<double, 5> samples = {-1.0, -0.5, 0.0, 0.5, 1.0};

Projection closest_on_patch(const BezierFacet& facet, const Vector3d& x) {
  Vector2d xi = Vector2d::Zero();
  double nearest = std::numeric_limits<double>::max();
  for (const double a : samples)
    for (const double b : samples) {
      const std::array<double, 2> sample = {a, b};
      const double square = (surface_point(facet, sample).place - x).squaredNorm();
      if (square >= nearest) continue;
      nearest = square;
      xi = {a, b};
    }
  const auto inside = [](const Vector2d& place) { return Vector2d(place.cwiseMax(-1.0).cwiseMin(1.0)); };
  for (int iteration = 0; iteration < 100; ++iteration) {
    const auto slope = slope_at(facet, x, xi);
    Vector2d step = descent_step(slope, xi);
    // Close to the minimum the distance does not resolve the progress any more.
    const bool is_guarded = step.lpNorm<Eigen::Infinity>() > 1e-6;
    Vector2d next = inside(xi + step);
    for (int halving = 0; is_guarded && halving < 30 && slope_at(facet, x, next).distance > slope.distance; ++halving) {
      step *= 0.5;
      next = inside(xi + step);
    }
    const double moved = (next - xi).lpNorm<Eigen::Infinity>();
    xi = next;
    if (moved <= 1e-14) break;
  }
  return landed(facet, x, {xi[0], xi[1]});
}

Projection meet_patch(const BezierFacet& facet, const Vector3d& x, const Vector3d& direction, double tolerance) {
  const Vector3d first = direction.unitOrthogonal(), second = direction.normalized().cross(first);
  Eigen::Matrix<double, 2, 3> across;
  across << first.transpose(), second.transpose();
  Projection best;
  for (const double a : {-0.5, 0.5})
    for (const double b : {-0.5, 0.5}) {
      Vector2d xi(a, b), step = Vector2d::Ones();
      for (int iteration = 0; iteration < 30 && step.lpNorm<Eigen::Infinity>() > 1e-14; ++iteration) {
        const auto at = surface_point(facet, std::span(xi.data(), 2));
        step = -Eigen::Matrix2d(across * at.tangents).fullPivLu().solve(across * (at.place - x));
        xi += step;
        if (!(xi.lpNorm<Eigen::Infinity>() < 3.0)) break; // far outside: not going to come back
      }
      if (!(step.lpNorm<Eigen::Infinity>() <= 1e-12 && xi.lpNorm<Eigen::Infinity>() <= 1.0 + tolerance)) continue;
      const Vector2d held = xi.cwiseMax(-1.0).cwiseMin(1.0);
      const auto next = landed(facet, x, {held[0], held[1]});
      if (next.found && (!best.found || next.distance < best.distance)) best = next;
    }
  return best;
}

} // namespace

BernsteinTable bernstein_table(int dim, std::span<const double> xi) {
  const auto first = bernstein(xi[0]);
  BernsteinTable table = BernsteinTable::Zero(6, dim == 2 ? 4 : 16);
  if (dim == 2) {
    table.row(0) = first.row(0);
    table.row(1) = first.row(1);
    table.row(3) = first.row(2);
    return table;
  }
  const auto second = bernstein(xi[1]);
  constexpr std::array<std::array<int, 2>, 6> orders = {{{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
  for (int row = 0; row < 6; ++row)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        table(row, 4 * j + i) = first(orders[row][0], i) * second(orders[row][1], j);
  return table;
}

SurfacePoint surface_point(const BezierFacet& facet, std::span<const double> xi) {
  const auto table = bernstein_table(facet.dim, xi);
  Eigen::Matrix<double, 3, 6> values = Eigen::Matrix<double, 3, 6>::Zero();
  const Eigen::Map<const Eigen::MatrixXd> control(facet.control.data(), facet.dim, table.cols());
  values.topRows(facet.dim) = control * table.transpose();
  SurfacePoint point{values.col(0), values.middleCols<2>(1), values.rightCols<3>()};
  if (facet.dim == 2) point.tangents(2, 1) = 1.0;
  return point;
}

Projection closest_point(const BezierFacet& facet, std::span<const double> x) {
  return facet.dim == 2 ? closest_on_curve(facet, x) : closest_on_patch(facet, padded(x));
}

Projection project_along(const BezierFacet& facet, std::span<const double> x, std::span<const double> direction,
                         double tolerance) {
  return facet.dim == 2 ? meet_curve(facet, x, direction, tolerance)
                        : meet_patch(facet, padded(x), padded(direction), tolerance);
}

} // namespace amontons
