// Cone, slip and dissipation of frictional pairs: the tractions and slips that the samples claim against the law, asked
// anew, and against the motion of the surfaces, searched anew.
#include "accuracy/checks.hpp"
#include "accuracy/gap_search.hpp"
#include "mesh/welded_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace amontons::accuracy {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

/// The law's limit at what is claimed of a point in contact.
double limit(const FrictionLaw& law, const ContactSamples& samples, std::size_t i) {
  const double slip = samples.status[i] == ContactStatus::Slip ? norm(samples.slip[i]) : 0.0;
  const double pressure = std::max(0.0, samples.pressure[i]);
  return friction_limit(law, samples.friction_context[i], pressure, slip, samples.friction_state_old[i]).tau;
}

/// How far the shear of a point is outside of what is allowed.
double excess(const ContactSamples& samples, std::size_t i, double tau) {
  const double size = norm(samples.shear[i]);
  if (samples.status[i] == ContactStatus::Open) return size;
  const double out_of_plane = std::abs(dot(samples.shear[i], samples.normal[i]));
  // In slip the shear is at the limit, neither above nor below.
  const double beyond = samples.status[i] == ContactStatus::Slip ? std::abs(size - tau) : size - tau;
  return std::max(beyond, out_of_plane);
}

void check_cone(const CertificateInput& input, std::size_t pair, Worst& worst) {
  const ContactSamples& samples = input.samples[pair];
  std::vector<double> limits(samples.shear.size(), 0.0);
  double largest = 0.0;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (samples.status[i] != ContactStatus::Open) limits[i] = limit(*input.pairs[pair].friction, samples, i);
    largest = std::max({largest, limits[i], norm(samples.shear[i])});
  }
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, input.mesh.comm);
  for (std::size_t i = 0; i < limits.size(); ++i)
    if (const double over = excess(samples, i, limits[i]); over > 0.0)
      worst.offer(over / largest, [&] {
        return "pair '" + input.pairs[pair].name + "' at " +
               place_text(std::span(samples.place[i]).first(input.mesh.dim));
      });
}

void check_dissipation(const CertificateInput& input, std::size_t pair, Worst& worst) {
  const ContactSamples& samples = input.samples[pair];
  std::array<double, 2> works{}; // −Σ min(0, work), Σ |work|
  for (std::size_t i = 0; i < samples.shear.size(); ++i) {
    const double work = -samples.weight[i] * dot(samples.shear[i], samples.slip[i]);
    works[0] += std::max(0.0, -work);
    works[1] += std::abs(work);
  }
  MPI_Allreduce(MPI_IN_PLACE, works.data(), 2, MPI_DOUBLE, MPI_SUM, input.mesh.comm);
  if (works[0] > 0.0) worst.offer(works[0] / works[1], [&] { return "pair '" + input.pairs[pair].name + "'"; });
}

/// Part of the largest displacement below which an increment of it is rounding.
constexpr double rest = 1e-6;

/// The largest displacement increment in the scene, rigid masters included; in a scene at rest a little. Collective.
double largest_increment(const CertificateInput& input) {
  double largest = 0.0;
  const auto include = [&](std::span<const double> displacement, double factor) {
    for (std::size_t node = 0; node < displacement.size(); node += input.mesh.dim) {
      Vector moved{};
      std::copy_n(displacement.begin() + static_cast<std::ptrdiff_t>(node), input.mesh.dim, moved.begin());
      largest = std::max(largest, factor * norm(moved));
    }
  };
  include(input.increment, 1.0);
  include(input.displacement, rest);
  for (const auto& pair : input.pairs)
    if (const auto* rigid = std::get_if<MovedShape>(&pair.master)) largest = std::max(largest, norm(rigid->increment));
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, input.mesh.comm);
  return largest;
}

/// Displacement increment of the slave relative to the master at the claimed points, from a search of its own. In
/// finite kinematics the search is in the last accepted configuration, and what is between the point and its projection
/// there belongs to it: where the point is now, seen from where that place of the master is now. Collective.
std::vector<Vector> moved_over_master(const CertificateInput& input, std::size_t pair) {
  const Mesh& mesh = input.mesh;
  const ContactSamples& samples = input.samples[pair];
  const FacetSet& slave = mesh.surfaces.at(input.pairs[pair].slave);
  const bool finite = input.kinematics == Kinematics::Finite;
  std::vector<double> start(finite ? input.displacement.size() : 0);
  for (std::size_t k = 0; k < start.size(); ++k)
    start[k] = input.displacement[k] - input.increment[k];
  const auto points_with = [&](std::span<const double> displacement) {
    std::vector<SlavePoint> points;
    for (std::size_t i = 0; i < samples.size(); ++i)
      points.push_back(slave_point(mesh, displacement, slave, samples.facet[i], samples.xi[i], start));
    return points;
  };
  const auto points = points_with(input.increment);
  std::vector<Vector> moved;
  if (const auto* rigid = std::get_if<MovedShape>(&input.pairs[pair].master)) {
    for (const SlavePoint& point : points) {
      moved.push_back(point.displacement);
      Vector shift = rigid->shift;
      for (std::size_t c = 0; c < 3; ++c) {
        moved.back()[c] -= rigid->increment[c];
        shift[c] -= rigid->increment[c];
      }
      if (!finite) continue;
      const auto before = signed_distance(rigid->shape, shift, std::span(point.place).first(mesh.dim));
      for (std::size_t c = 0; c < 3; ++c)
        moved.back()[c] += before.gap * before.normal[c];
    }
    return moved;
  }
  const FacetSet& master = mesh.surfaces.at(std::get<std::string>(input.pairs[pair].master));
  const auto reaching = finite ? input.increment : input.displacement;
  const double reach = reach_of(mesh, reaching, master, points_with(reaching), start);
  const auto welded = welded_bodies(mesh);
  const auto opposite = opposite_of(input.pairs[pair], welded);
  for (const MasterHit& hit : find_on_master(mesh, input.increment, master, points, reach, start, opposite)) {
    moved.push_back(hit.jump);
    for (std::size_t c = 0; finite && c < 3; ++c)
      moved.back()[c] += hit.away[c];
  }
  return moved;
}

void check_slip(const CertificateInput& input, std::size_t pair, double scale, Worst& worst) {
  const ContactSamples& samples = input.samples[pair];
  const std::vector<Vector> moved = moved_over_master(input, pair);
  std::array<double, 2> sums{}; // Σ |shear| |Δg_t − slip| w, Σ |shear| w
  for (std::size_t i = 0; i < samples.shear.size(); ++i) {
    const double along = dot(moved[i], samples.normal[i]);
    Vector unexplained;
    for (std::size_t c = 0; c < 3; ++c)
      unexplained[c] = moved[i][c] - along * samples.normal[i][c] - samples.slip[i][c];
    const double weight = samples.weight[i] * norm(samples.shear[i]);
    sums[0] += weight * norm(unexplained);
    sums[1] += weight;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM, input.mesh.comm);
  if (sums[0] > 0.0) worst.offer(sums[0] / (sums[1] * scale), [&] { return "pair '" + input.pairs[pair].name + "'"; });
}

} // namespace

FrictionChecks check_friction(const CertificateInput& input) {
  FrictionChecks checks;
  const bool any = std::any_of(input.pairs.begin(), input.pairs.end(), [](const auto& pair) { return pair.friction; });
  const double scale = any ? largest_increment(input) : 0.0;
  for (std::size_t pair = 0; pair < input.pairs.size(); ++pair) {
    if (!input.pairs[pair].friction) continue;
    check_cone(input, pair, checks.cone);
    check_slip(input, pair, scale, checks.slip);
    check_dissipation(input, pair, checks.dissipation);
  }
  checks.cone = over_ranks(input.mesh.comm, std::move(checks.cone));
  return checks;
}

} // namespace amontons::accuracy
