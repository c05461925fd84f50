#include "accuracy/gap_search.hpp"

#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace amontons::accuracy {

namespace {

using Vector = Eigen::Vector3d;

/// Surfaces face each other when the cosine between their outward normals is below minus this.
constexpr double facing = 0.1;
/// Relative to the facet size: distances equal up to this are ties, a point beyond the rim by less is over the surface.
constexpr double tie = 1e-9, rim = 1e-6;

Vector vector(const std::array<double, 3>& v) { return Vector(v.data()); }

/// A penetration is less than this part of the way through the material that it had in the reference configuration.
constexpr double shortened = 0.25;

/// The facets that share the closest point among those facing the slave point, and the nearest one that looks the same
/// way as the slave point does (of another surface) or is the other side of its own wall (of the same surface).
struct Nearest {
  std::vector<Projection> ties;
  std::vector<std::int32_t> facets;
  double distance = no_limit;
  double back = no_limit;
  static constexpr double no_limit = 1e300;
};

/// See Opposite.
bool is_own_wall(const FacetCloud& master, std::int32_t f, const SlavePoint& point, const Projection& projection,
                 const SameSurface& same) {
  if (same.welded[point.body] != same.welded[master.body(f)]) return false;
  if (vector(projection.normal).dot(vector(point.place) - vector(projection.point)) >= 0.0) return false;
  const Vector way = vector(master.origin_at(f, projection.xi)) - vector(point.origin);
  return way.dot(vector(point.origin_normal)) < -tie * way.norm() && projection.distance > shortened * way.norm();
}

void look_at(const FacetCloud& master, std::int32_t f, const SlavePoint& point, std::span<const double> x,
             const Opposite& opposite, Nearest& nearest) {
  if (box_distance(master.box(f), x) > nearest.distance * (1.0 + tie) + tie * point.size) return;
  const Projection projection = closest_point(master.type(f), master.positions(f), x);
  if (!projection.found) return;
  const double cosine = vector(projection.normal).dot(vector(point.normal));
  const auto* same = std::get_if<SameSurface>(&opposite);
  if (!same && cosine > facing) nearest.back = std::min(nearest.back, projection.distance);
  if (cosine > -facing) return;
  if (same && is_own_wall(master, f, point, projection, *same)) {
    nearest.back = std::min(nearest.back, projection.distance);
    return;
  }
  if (projection.distance < nearest.distance - tie * point.size) {
    nearest.ties.clear();
    nearest.facets.clear();
  }
  if (projection.distance > nearest.distance + tie * point.size) return;
  nearest.distance = std::min(nearest.distance, projection.distance);
  nearest.ties.push_back(projection);
  nearest.facets.push_back(f);
}

Nearest nearest_facets(const FacetCloud& master, const SlavePoint& point, std::span<const double> x, double reach,
                       const Opposite& opposite, std::vector<std::int32_t>& scratch) {
  Nearest nearest;
  for (double radius = std::min(0.5 * point.size, reach);; radius = std::min(2.0 * radius, reach)) {
    Box box;
    box.include(x);
    box.inflate(radius);
    master.tree().query(box, scratch);
    nearest = {};
    for (const std::int32_t f : scratch)
      look_at(master, f, point, x, opposite, nearest);
    // A facet outside of the box is farther than the radius.
    if (nearest.distance <= radius * (1.0 - 2.0 * tie) || radius >= reach) return nearest;
  }
}

/// The gap at a closest point on edges or vertices only: see MasterHit.
void find_gap_on_edge(const Nearest& nearest, const SlavePoint& point, const Vector& r, const Vector& moved,
                      double size, MasterHit& hit) {
  std::vector<std::array<double, 3>> normals;
  for (const Projection& projection : nearest.ties)
    normals.push_back(projection.normal);
  hit.gap = -Nearest::no_limit;
  double height = 0.0;
  for (const auto& normal : normals) {
    const Vector n = vector(normal);
    hit.gap = std::max(hit.gap, n.dot(r + moved));
    if (std::abs(n.dot(r)) >= std::abs(height)) height = n.dot(r);
  }
  if (r.norm() <= tie * std::max(size, point.size)) return;
  for (const double sign : {1.0, -1.0}) {
    const Vector outwards = sign * r;
    if (distance_to_cone({outwards[0], outwards[1], outwards[2]}, normals) > rim * size) continue;
    hit.gap = sign * (r.norm() + r.normalized().dot(moved));
    return;
  }
  hit.beyond = std::sqrt(std::max(0.0, r.squaredNorm() - height * height));
}

MasterHit hit_of(const FacetCloud& master, const Nearest& nearest, const SlavePoint& point) {
  MasterHit hit;
  if (nearest.ties.empty()) return hit;
  std::size_t best = 0; // the first tie inside a facet, if any
  for (std::size_t i = 0; i < nearest.ties.size(); ++i)
    if (nearest.ties[i].feature == Feature::Facet && nearest.ties[best].feature != Feature::Facet) best = i;
  const Projection& projection = nearest.ties[best];
  const std::int32_t f = nearest.facets[best];
  const double size = master.facet_size(f);
  const Vector r = vector(point.place) - vector(projection.point);
  const Vector moved = vector(point.displacement) - vector(master.displacement_at(f, projection.xi));
  // Behind the surface by more than a facet, or with a back side in between, the point looks at the master from within.
  const double height = vector(projection.normal).dot(r);
  if (height < 0.0 && (-height > std::max(size, point.size) || nearest.back < nearest.distance)) return hit;
  hit.found = true;
  hit.body = master.body(f);
  hit.jump = {moved[0], moved[1], moved[2]};
  hit.away = {r[0], r[1], r[2]};
  if (projection.feature == Feature::Facet)
    hit.gap = height + vector(projection.normal).dot(moved);
  else
    find_gap_on_edge(nearest, point, r, moved, size, hit);
  return hit;
}

} // namespace

Opposite opposite_of(const ContactPairNames& pair, std::span<const std::int32_t> welded) {
  if (std::get<std::string>(pair.master) != pair.slave) return OtherSurface{};
  return SameSurface{welded};
}

SlavePoint slave_point(const Mesh& mesh, std::span<const double> displacement, const FacetSet& slave, std::int32_t f,
                       std::span<const double> xi, std::span<const double> start) {
  const ElementType type = slave.types[f];
  const auto nodes = slave.facet(f);
  const auto positions =
      positions_of(mesh, start, nodes, start.empty() ? Configuration::Reference : Configuration::Current);
  const auto moved = nodal_values(mesh, displacement, nodes), origins = nodal_values(mesh, mesh.coordinates, nodes);
  std::array<double, 9> shape;
  const auto at = xi.first(element_dim(type));
  shape_values(type, at, std::span(shape).first(nodes.size()));
  SlavePoint point;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int c = 0; c < mesh.dim; ++c) {
      point.place[c] += shape[a] * positions[a * mesh.dim + c];
      point.displacement[c] += shape[a] * moved[a * mesh.dim + c];
      point.origin[c] += shape[a] * origins[a * mesh.dim + c];
    }
  facet_normal(type, positions, at, point.normal);
  facet_normal(type, origins, at, point.origin_normal);
  point.body = slave.bodies[f];
  point.size = facet_size(type, positions);
  return point;
}

double reach_of(const Mesh& mesh, std::span<const double> displacement, const FacetSet& master,
                std::span<const SlavePoint> points, std::span<const double> start) {
  Box range;
  double size = 0.0;
  for (const SlavePoint& point : points) {
    range.include(point.displacement);
    size = std::max(size, point.size);
  }
  for (const std::int32_t node : master.nodes)
    range.include(displacement.subspan(std::size_t(node) * mesh.dim, mesh.dim));
  for (std::int32_t f = 0; f < master.size(); ++f)
    size = std::max(size, facet_size(master.types[f],
                                     positions_of(mesh, start, master.facet(f),
                                                  start.empty() ? Configuration::Reference : Configuration::Current)));
  for (const Box& box : boxes_of_ranks(mesh.comm, std::span(&range, 1)))
    range.include(box);
  MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return range.diagonal() + size;
}

double distance_to_cone(const std::array<double, 3>& r, std::span<const std::array<double, 3>> normals) {
  // The closest point of the cone is a combination of at most three of the normals, and then the orthogonal projection
  // on their span.
  std::vector<Vector> n;
  for (const auto& normal : normals)
    if (std::none_of(n.begin(), n.end(), [&](const Vector& other) { return other.dot(vector(normal)) > 1.0 - 1e-14; }))
      n.push_back(vector(normal));
  const Vector target = vector(r);
  double distance = target.norm();
  const auto project_on = [&](const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>& span) {
    const Eigen::VectorXd a = span.colPivHouseholderQr().solve(target);
    if ((a.array() >= 0.0).all()) distance = std::min(distance, (target - span * a).norm());
  };
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> span;
  for (std::size_t i = 0; i < n.size(); ++i) {
    span.resize(3, 1);
    span.col(0) = n[i];
    project_on(span);
    for (std::size_t j = i + 1; j < n.size(); ++j) {
      span.resize(3, 2);
      span << n[i], n[j];
      project_on(span);
      for (std::size_t k = j + 1; k < n.size(); ++k) {
        span.resize(3, 3);
        span << n[i], n[j], n[k];
        project_on(span);
      }
    }
  }
  return distance;
}

std::vector<MasterHit> find_on_master(const Mesh& mesh, std::span<const double> displacement, const FacetSet& master,
                                      std::span<const SlavePoint> points, double reach, std::span<const double> start,
                                      const Opposite& opposite) {
  Box wanted;
  for (const SlavePoint& point : points)
    wanted.include(std::span(point.place).first(mesh.dim));
  wanted.inflate(reach);
  const FacetCloud cloud = FacetCloud::moving(mesh, start, displacement, master).gathered(mesh.comm, wanted);
  std::vector<MasterHit> hits;
  std::vector<std::int32_t> scratch;
  for (const SlavePoint& point : points) {
    const auto x = std::span(point.place).first(mesh.dim);
    hits.push_back(hit_of(cloud, nearest_facets(cloud, point, x, reach, opposite, scratch), point));
  }
  return hits;
}

} // namespace amontons::accuracy
