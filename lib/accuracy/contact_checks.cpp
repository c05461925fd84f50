// Penetration, complementarity and tension of the contact pairs.
#include "accuracy/checks.hpp"
#include "accuracy/gap_search.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>

namespace amontons::accuracy {

namespace {

/// Parts of the largest pressure and of the total force of all pairs below which those of one pair are rounding.
constexpr double pressure_floor = 1e-4, force_floor = 1e-6;

/// Slave points of a pair: first the claimed ones, in the order of the samples, then those of the certificate.
struct PairPoints {
  std::vector<SlavePoint> points;
  std::size_t num_claimed = 0;
};

/// The certificate's own points: every node of every slave facet, and a quadrature rule inside.
PairPoints points_of_pair(const CertificateInput& input, const FacetSet& slave, const ContactSamples& samples) {
  PairPoints result;
  for (std::size_t i = 0; i < samples.size(); ++i)
    result.points.push_back(slave_point(input.mesh, input.displacement, slave, samples.facet[i], samples.xi[i]));
  result.num_claimed = samples.size();
  for (std::int32_t f = 0; f < slave.size(); ++f) {
    const auto nodes = reference_nodes(slave.types[f]);
    const Quadrature& rule = quadrature(slave.types[f], 3);
    const std::size_t d = element_dim(slave.types[f]);
    for (const std::span<const double> places : {nodes, std::span<const double>(rule.points)})
      for (std::size_t at = 0; at < places.size(); at += d)
        result.points.push_back(slave_point(input.mesh, input.displacement, slave, f, places.subspan(at, d)));
  }
  return result;
}

std::vector<MasterHit> find_on_shape(const MovedShape& master, const Mesh& mesh, std::span<const SlavePoint> points) {
  std::vector<MasterHit> hits;
  for (const SlavePoint& point : points) {
    const auto contact = signed_distance(master.shape, master.shift, std::span(point.place).first(mesh.dim));
    MasterHit hit;
    hit.found = true;
    hit.gap = contact.gap;
    for (std::size_t c = 0; c < 3; ++c)
      hit.gap += contact.normal[c] * point.displacement[c];
    hits.push_back(hit);
  }
  return hits;
}

std::vector<MasterHit> find_on_surface(const CertificateInput& input, const ContactPairNames& names,
                                       std::span<const SlavePoint> points) {
  const FacetSet& master = input.mesh.surfaces.at(std::get<std::string>(names.master));
  const double reach = reach_of(input.mesh, input.displacement, master, points);
  return find_on_master(input.mesh, input.displacement, master, points, reach);
}

/// The gap that a claimed pressure is held against: where there is no master the distance to it, at least a facet.
double gap_under_pressure(const MasterHit& hit, double size) {
  return hit.found ? std::max(std::abs(hit.gap), hit.beyond) : size;
}

/// Adds the forces that the samples claim to the bodies of both sides. That of the pressure on the master acts on the
/// same line as on the slave, so its moment may be taken at the slave's point. Shear acts across that line at the
/// master's own point, as far away as the two are in the reference configuration, where small kinematics balance
/// forces: the couple that remains is of the order of what they neglect, and belongs to the balance of the whole scene.
void add_forces(const ContactSamples& samples, const FacetSet& slave, std::span<const MasterHit> hits, bool is_rigid,
                const std::array<double, 3>& pivot, ClaimedForces& forces) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::array<double, 3> traction = samples.traction(i);
    std::array<double, 3> on_slave{}, pressure_on_master{}, shear_on_master{};
    for (std::size_t c = 0; c < 3; ++c) {
      on_slave[c] = samples.weight[i] * traction[c];
      pressure_on_master[c] = -samples.weight[i] * samples.pressure[i] * samples.normal[i][c];
      shear_on_master[c] = -on_slave[c] - pressure_on_master[c];
    }
    forces.absolute += std::hypot(traction[0], traction[1], traction[2]) * samples.weight[i];
    add_wrench(forces.on_body[slave.bodies[samples.facet[i]]], samples.place[i], pivot, on_slave);
    // The force on the master acts on the same line: its moment may be taken at the slave's point.
    if (is_rigid)
      add_wrench(forces.by_rigid, samples.place[i], pivot, on_slave);
    else if (hits[i].found) {
      auto& on_master = forces.on_body[hits[i].body];
      add_wrench(on_master, samples.place[i], pivot, pressure_on_master);
      add_wrench(on_master, hits[i].place, pivot, shear_on_master);
      add_wrench(forces.couple, samples.place[i], hits[i].place, shear_on_master);
    }
  }
}

} // namespace

GapChecks check_gaps(const CertificateInput& input, const std::array<double, 3>& pivot, ClaimedForces& forces) {
  const Mesh& mesh = input.mesh;
  const std::size_t count = input.pairs.size();
  forces.on_body.assign(mesh.bodies.size(), {});
  GapChecks result;
  std::vector<double> sums(2 * count, 0.0); // per pair Σ |p g| w / h, Σ |p| w
  for (std::size_t pair = 0; pair < count; ++pair) {
    const ContactPairNames& names = input.pairs[pair];
    const ContactSamples& samples = input.samples[pair];
    const FacetSet& slave = mesh.surfaces.at(names.slave);
    const PairPoints all = points_of_pair(input, slave, samples);
    const auto* shape = std::get_if<MovedShape>(&names.master);
    const std::vector<MasterHit> hits =
        shape != nullptr ? find_on_shape(*shape, mesh, all.points) : find_on_surface(input, names, all.points);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].found || hits[i].beyond > 0.0) continue;
      result.penetration.offer(-hits[i].gap / all.points[i].size, [&] {
        return "pair '" + names.name + "' at " + place_text(std::span(all.points[i].place).first(mesh.dim));
      });
    }
    for (std::size_t i = 0; i < all.num_claimed; ++i) {
      const double force = std::abs(samples.pressure[i]) * samples.weight[i], size = all.points[i].size;
      if (force > 0.0) sums[2 * pair] += force * gap_under_pressure(hits[i], size) / size;
      sums[2 * pair + 1] += force;
    }
    add_forces(samples, slave, hits, shape != nullptr, pivot, forces);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  double total = 0.0;
  for (std::size_t pair = 0; pair < count; ++pair)
    total += sums[2 * pair + 1];
  for (std::size_t pair = 0; pair < count; ++pair)
    if (sums[2 * pair] != 0.0)
      result.complementarity.offer(sums[2 * pair] / std::max(sums[2 * pair + 1], force_floor * total),
                                   [&] { return "pair '" + input.pairs[pair].name + "'"; });
  result.penetration = over_ranks(mesh.comm, std::move(result.penetration));
  return result;
}

Worst check_tension(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  std::vector<double> largest(input.pairs.size(), 0.0);
  for (std::size_t pair = 0; pair < largest.size(); ++pair)
    for (const auto* pressures : {&input.samples[pair].pressure, &input.samples[pair].nodal_pressure})
      for (const double pressure : *pressures)
        largest[pair] = std::max(largest[pair], pressure);
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(largest.size()), MPI_DOUBLE, MPI_MAX, mesh.comm);
  const double overall = largest.empty() ? 0.0 : *std::max_element(largest.begin(), largest.end());
  std::vector<double> areas(input.pairs.size(), 0.0);
  for (std::size_t pair = 0; pair < areas.size(); ++pair)
    for (const double weight : input.samples[pair].weight)
      areas[pair] += weight;
  MPI_Allreduce(MPI_IN_PLACE, areas.data(), static_cast<int>(areas.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  Worst worst;
  for (std::size_t pair = 0; pair < largest.size(); ++pair) {
    const ContactSamples& samples = input.samples[pair];
    // With every pair open the pressures are rounding, and so is the largest of them.
    const double rounding = areas[pair] > 0.0 ? input.force_floor / areas[pair] : 0.0;
    const double scale = std::max({largest[pair], pressure_floor * overall, rounding});
    const auto offer = [&](double pressure, std::span<const double> place) {
      if (pressure >= 0.0) return;
      worst.offer(-pressure / scale, [&] { return "pair '" + input.pairs[pair].name + "' at " + place_text(place); });
    };
    for (std::size_t i = 0; i < samples.size(); ++i)
      offer(samples.pressure[i], std::span(samples.place[i]).first(mesh.dim));
    for (std::size_t i = 0; i < samples.nodes.size(); ++i)
      offer(samples.nodal_pressure[i], mesh.position(samples.nodes[i]));
  }
  return over_ranks(mesh.comm, std::move(worst));
}

} // namespace amontons::accuracy
