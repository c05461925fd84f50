// Penetration, complementarity and tension of the contact pairs.
#include "accuracy/checks.hpp"
#include "accuracy/gap_search.hpp"
#include "math/reference_element.hpp"
#include "mesh/welded_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace amontons::accuracy {

namespace {

/// Parts of the largest pressure and of the total force of all pairs below which those of one pair are rounding.
constexpr double pressure_floor = 1e-4, force_floor = 1e-6;

/// Slave points of a pair: first the claimed ones, in the order of the samples, then those of the certificate.
struct PairPoints {
  std::vector<SlavePoint> points;
  std::size_t num_claimed = 0;
};

/// From where and how far the surfaces have moved when gaps are taken: see gap_search.hpp.
struct Placement {
  std::span<const double> start, displacement;
};

/// The certificate's own points: every node of every slave facet, and a quadrature rule inside.
PairPoints points_of_pair(const CertificateInput& input, const Placement& placement, const FacetSet& slave,
                          const ContactSamples& samples) {
  PairPoints result;
  const auto add = [&](std::int32_t f, std::span<const double> xi) {
    result.points.push_back(slave_point(input.mesh, placement.displacement, slave, f, xi, placement.start));
  };
  for (std::size_t i = 0; i < samples.size(); ++i)
    add(samples.facet[i], samples.xi[i]);
  result.num_claimed = samples.size();
  for (std::int32_t f = 0; f < slave.size(); ++f) {
    const auto nodes = reference_nodes(slave.types[f]);
    const Quadrature& rule = quadrature(slave.types[f], 3);
    const std::size_t d = element_dim(slave.types[f]);
    for (const std::span<const double> places : {nodes, std::span<const double>(rule.points)})
      for (std::size_t at = 0; at < places.size(); at += d)
        add(f, places.subspan(at, d));
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
    hit.jump = point.displacement;
    for (std::size_t c = 0; c < 3; ++c) {
      hit.gap += contact.normal[c] * point.displacement[c];
      hit.away[c] = contact.gap * contact.normal[c];
    }
    hits.push_back(hit);
  }
  return hits;
}

std::vector<MasterHit> find_on_surface(const CertificateInput& input, const Placement& placement,
                                       const ContactPairNames& names, std::span<const SlavePoint> points) {
  const FacetSet& master = input.mesh.surfaces.at(std::get<std::string>(names.master));
  const auto& [start, displacement] = placement;
  const double reach = reach_of(input.mesh, displacement, master, points, start);
  const auto welded = welded_bodies(input.mesh);
  return find_on_master(input.mesh, displacement, master, points, reach, start, opposite_of(names, welded));
}

std::vector<MasterHit> find_hits(const CertificateInput& input, const Placement& placement,
                                 const ContactPairNames& names, std::span<const SlavePoint> points) {
  const auto* shape = std::get_if<MovedShape>(&names.master);
  return shape != nullptr ? find_on_shape(*shape, input.mesh, points)
                          : find_on_surface(input, placement, names, points);
}

/// What the points find where they are now. Small kinematics has searched in the reference configuration; a point now
/// stands over the reference master where its motion relative to its master has taken it. Finite kinematics has
/// searched where the points are.
std::vector<MasterHit> find_now(const CertificateInput& input, const Placement& placement,
                                const ContactPairNames& names, std::span<const SlavePoint> points,
                                std::span<const MasterHit> hits) {
  if (input.kinematics == Kinematics::Finite) return {hits.begin(), hits.end()};
  std::vector<SlavePoint> moved(points.begin(), points.end());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      moved[i].place[c] += hits[i].jump[c];
    moved[i].displacement = {};
  }
  return find_hits(input, placement, names, moved);
}

/// How far a point is from the nearest place of the master across the normal that its pressure acts along, in facets;
/// 1 where it is a facet or more, or no master is near. Over a master, also a curved one, a point in contact has it
/// below it; beyond a rim or an edge, or where a rigid shape has curved away, beside it.
double facets_beside(const MasterHit& hit, const std::array<double, 3>& normal, double size) {
  if (!hit.found) return 1.0;
  double height = 0.0, square = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    height += hit.away[c] * normal[c];
  for (std::size_t c = 0; c < 3; ++c)
    square += std::pow(hit.away[c] - height * normal[c], 2);
  return std::min(1.0, std::sqrt(square) / size);
}

/// The gap that a claimed pressure is held against: where there is no master the distance to it, at least a facet.
double gap_under_pressure(const MasterHit& hit, double size) {
  return hit.found ? std::max(std::abs(hit.gap), hit.beyond) : size;
}

/// Adds the forces that the samples claim to the bodies of both sides. That of the pressure on the master acts on the
/// same line as on the slave, so its moment may be taken at the slave's point. Shear acts across that line: at the
/// master's own point, as far away as the two are, where small kinematics balance forces (the couple that remains is of
/// the order of what they neglect, and belongs to the balance of the whole scene), or in finite kinematics at the place
/// that the pair names, the same on both.
void add_forces(const ContactSamples& samples, const FacetSet& slave, std::span<const SlavePoint> points,
                std::span<const MasterHit> hits, bool is_rigid, const std::array<double, 3>& pivot,
                ClaimedForces& forces) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::array<double, 3> traction = samples.traction(i);
    std::array<double, 3> on_slave{}, pressure_on_master{}, shear_on_master{};
    for (std::size_t c = 0; c < 3; ++c) {
      on_slave[c] = samples.weight[i] * traction[c];
      pressure_on_master[c] = -samples.weight[i] * samples.pressure[i] * samples.normal[i][c];
      shear_on_master[c] = -on_slave[c] - pressure_on_master[c];
    }
    const auto& place = samples.acts_at.empty() ? points[i].place : samples.acts_at[i];
    forces.absolute += std::hypot(traction[0], traction[1], traction[2]) * samples.weight[i];
    add_wrench(forces.on_body[slave.bodies[samples.facet[i]]], place, pivot, on_slave);
    // The force on the master acts on the same line: its moment may be taken at the same place.
    if (is_rigid)
      add_wrench(forces.by_rigid, place, pivot, on_slave);
    else if (hits[i].found) {
      auto on_other_side = place;
      for (std::size_t c = 0; samples.acts_at.empty() && c < 3; ++c)
        on_other_side[c] -= hits[i].away[c];
      auto& on_master = forces.on_body[hits[i].body];
      add_wrench(on_master, place, pivot, pressure_on_master);
      add_wrench(on_master, on_other_side, pivot, shear_on_master);
      add_wrench(forces.couple, place, on_other_side, shear_on_master);
    }
  }
}

/// Of one pair: Σ |p g| w / h, Σ |p| w, and the latter times the distances beside the master in facets.
struct PairSums {
  double over_gaps = 0.0, force = 0.0, beside = 0.0;
};
constexpr int num_sums = sizeof(PairSums) / sizeof(double);
/// Where Σ |p g| w / h has its largest part, and the point that has come to be farthest beside the master.
struct PairPlaces {
  Worst gap, beside;
};

/// `hits`, `now`: what the points found where they were searched for, and where they are. Beside the
/// master counts what is so now and was not before (a node of a slave that sticks out of its master from the start
/// stands for a force over it).
void add_pressures(const ContactSamples& samples, std::span<const SlavePoint> points, std::span<const MasterHit> hits,
                   std::span<const MasterHit> now, int dim, PairSums& sums, PairPlaces& places) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double force = std::abs(samples.pressure[i]) * samples.weight[i], size = points[i].size;
    sums.force += force;
    if (force == 0.0) continue;
    const double before = facets_beside(hits[i], samples.normal[i], size);
    const double beside = std::max(0.0, facets_beside(now[i], samples.normal[i], size) - before);
    const double over_gap = force * gap_under_pressure(hits[i], size) / size;
    sums.over_gaps += over_gap;
    sums.beside += force * beside;
    const auto place = [&] { return place_text(std::span(samples.place[i]).first(dim)); };
    places.gap.offer(over_gap, place);
    places.beside.offer(beside, place);
  }
}

/// Where points have left their master, and what to do about it. `farthest`: in facets.
std::string left_words(const Worst& farthest) {
  std::ostringstream words;
  words.precision(2);
  words << ": points under pressure have left the master, the farthest, from " << farthest.where << ", by ";
  if (farthest.value < 1.0)
    words << farthest.value << " facets";
  else
    words << "a facet or more";
  words << "; small kinematics carries them on as if it were still there: use kinematics: finite, or a master that"
           " reaches as far as the motion";
  return words.str();
}

} // namespace

GapChecks check_gaps(const CertificateInput& input, const std::array<double, 3>& pivot, ClaimedForces& forces) {
  const Mesh& mesh = input.mesh;
  const std::size_t count = input.pairs.size();
  forces.on_body.assign(mesh.bodies.size(), {});
  GapChecks result;
  const std::vector<double> at_rest(input.kinematics == Kinematics::Finite ? input.displacement.size() : 0, 0.0);
  const Placement placement = input.kinematics == Kinematics::Finite ? Placement{input.displacement, at_rest}
                                                                     : Placement{{}, input.displacement};
  std::vector<PairSums> sums(count);
  std::vector<PairPlaces> places(count);
  for (std::size_t pair = 0; pair < count; ++pair) {
    const ContactPairNames& names = input.pairs[pair];
    const ContactSamples& samples = input.samples[pair];
    const PairPoints all = points_of_pair(input, placement, mesh.surfaces.at(names.slave), samples);
    const std::vector<MasterHit> hits = find_hits(input, placement, names, all.points);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].found || hits[i].beyond > 0.0) continue;
      result.penetration.offer(-hits[i].gap / all.points[i].size, [&] {
        return "pair '" + names.name + "' at " + place_text(std::span(all.points[i].place).first(mesh.dim));
      });
    }
    const std::span claimed(all.points.data(), all.num_claimed);
    add_pressures(samples, claimed, hits,
                  find_now(input, placement, names, claimed, std::span(hits).first(claimed.size())), mesh.dim,
                  sums[pair], places[pair]);
    add_forces(samples, mesh.surfaces.at(names.slave), all.points, hits,
               std::holds_alternative<MovedShape>(names.master), pivot, forces);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(count) * num_sums, MPI_DOUBLE, MPI_SUM, mesh.comm);
  double total = 0.0;
  for (const auto& sum : sums)
    total += sum.force;
  for (std::size_t pair = 0; pair < count; ++pair) {
    const double scale = std::max(sums[pair].force, force_floor * total);
    const auto name = "pair '" + input.pairs[pair].name + "'";
    const auto most = over_ranks(mesh.comm, std::move(places[pair].gap));
    const auto far = over_ranks(mesh.comm, std::move(places[pair].beside));
    if (sums[pair].over_gaps != 0.0)
      result.complementarity.offer(sums[pair].over_gaps / scale, [&] { return name + ", largest at " + most.where; });
    const double left = sums[pair].beside == 0.0 ? 0.0 : sums[pair].beside / scale;
    result.left_master.offer(left,
                             [&] { return name + (left <= input.tolerances.complementarity ? "" : left_words(far)); });
  }
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
