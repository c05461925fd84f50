// The look for contacts that nobody declared, or that went unseen: nodes of one body inside another, now. In finite
// kinematics also nodes of a body inside cells of the same body that they do not belong to: folded onto itself.
#include "accuracy/checks.hpp"
#include "accuracy/facet_cloud.hpp"
#include "accuracy/inside_cell.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace amontons::accuracy {

namespace {

/// A boundary node of a body where it is now.
struct Probe {
  std::array<double, 3> place{};
  std::int32_t body = -1;
  double node = -1.0; // global number
  double size = 0.0;  // of the largest facet around it
};
/// Facets nearer than this part of a facet are those that a node lies on.
constexpr double touching = 1e-9;
constexpr std::size_t probe_length = 6; // numbers that a probe travels as

void pack(const Probe& probe, std::vector<double>& message) {
  message.insert(message.end(),
                 {probe.place[0], probe.place[1], probe.place[2], double(probe.body), probe.node, probe.size});
}

std::vector<Probe> unpacked(std::span<const double> message) {
  std::vector<Probe> probes;
  for (std::size_t at = 0; at < message.size(); at += probe_length)
    probes.push_back({{message[at], message[at + 1], message[at + 2]},
                      static_cast<std::int32_t>(message[at + 3]),
                      message[at + 4],
                      message[at + 5]});
  return probes;
}

/// Nodes of this rank's exterior facets, once for each body.
std::vector<Probe> local_probes(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  std::map<std::pair<std::int32_t, std::int32_t>, double> sizes; // (body, node) -> size
  for (std::int32_t f = 0; f < mesh.exterior.size(); ++f) {
    const auto nodes = mesh.exterior.facet(f);
    const double size =
        facet_size(mesh.exterior.types[f], positions_of(mesh, input.displacement, nodes, Configuration::Current));
    for (const std::int32_t node : nodes) {
      double& known = sizes[{mesh.exterior.bodies[f], node}];
      known = std::max(known, size);
    }
  }
  std::vector<Probe> probes;
  for (const auto& [key, size] : sizes) {
    Probe probe{{}, key.first, double(mesh.global_node(key.second)), size};
    for (int c = 0; c < mesh.dim; ++c)
      probe.place[c] = mesh.position(key.second)[c] + input.displacement[std::size_t(key.second) * mesh.dim + c];
    probes.push_back(probe);
  }
  return probes;
}

/// Current boxes of this rank's part of each body.
std::vector<Box> body_boxes(const CertificateInput& input) {
  std::vector<Box> boxes(input.mesh.bodies.size());
  for (const CellBlock& block : input.mesh.blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = positions_of(input.mesh, input.displacement, block.cell(c), Configuration::Current);
      for (std::size_t i = 0; i < nodes.size(); i += input.mesh.dim)
        boxes[block.body].include(std::span(nodes).subspan(i, input.mesh.dim));
    }
  return boxes;
}

/// May a body meet itself? In small kinematics displacements are too small to mean that.
bool looks_into_own_body(const CertificateInput& input) { return input.kinematics == Kinematics::Finite; }

/// The probes of all ranks that lie in the box of this rank's part of a body to look into. Collective.
std::vector<Probe> foreign_probes(const CertificateInput& input, std::span<const Probe> mine) {
  const std::size_t bodies = input.mesh.bodies.size();
  const std::vector<Box> boxes = boxes_of_ranks(input.mesh.comm, body_boxes(input));
  std::vector<std::vector<double>> outgoing(boxes.size() / bodies);
  for (const Probe& probe : mine) {
    Box here;
    here.include(std::span(probe.place).first(input.mesh.dim));
    for (std::size_t rank = 0; rank < outgoing.size(); ++rank)
      for (std::size_t body = 0; body < bodies; ++body)
        if ((std::int32_t(body) != probe.body || looks_into_own_body(input)) &&
            boxes[rank * bodies + body].meets(here)) {
          pack(probe, outgoing[rank]);
          break;
        }
  }
  return unpacked(exchanged(input.mesh.comm, outgoing));
}

/// A probe inside a cell of body `inside`.
struct Intruder {
  Probe probe;
  std::int32_t inside;
};

std::vector<Intruder> find_intruders(const CertificateInput& input, std::span<const Probe> probes) {
  const Mesh& mesh = input.mesh;
  std::vector<Box> places(probes.size());
  Box all;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    places[i].include(std::span(probes[i].place).first(mesh.dim));
    all.include(places[i]);
  }
  const BoxTree tree(places);
  std::vector<Intruder> intruders;
  std::set<std::pair<std::int32_t, std::int32_t>> known; // (probe, body)
  std::vector<std::int32_t> found;
  for (const CellBlock& block : mesh.blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = block.cell(c);
      const auto positions = positions_of(mesh, input.displacement, nodes, Configuration::Current);
      Box box;
      for (std::size_t i = 0; i < positions.size(); i += mesh.dim)
        box.include(std::span(positions).subspan(i, mesh.dim));
      if (!box.meets(all)) continue;
      tree.query(box, found);
      for (const std::int32_t i : found) {
        const Probe& probe = probes[i];
        // A node that the cell has too is where two bodies are welded together.
        const auto same = [&](std::int32_t node) { return double(mesh.global_node(node)) == probe.node; };
        if ((probe.body == block.body && !looks_into_own_body(input)) || std::any_of(nodes.begin(), nodes.end(), same))
          continue;
        if (!is_inside(block.type, positions, std::span(probe.place).first(mesh.dim))) continue;
        if (known.emplace(i, block.body).second) intruders.push_back({probe, block.body});
      }
    }
  return intruders;
}

/// Depth of an intruder under the boundary of the body it is in, and the facet size to compare with: the larger of
/// those on both sides.
struct Depth {
  double depth = no_value;
  double size = 0.0;
};

/// As far as this cloud of facets knows; looks no farther than `limit`.
Depth depth_of(const Intruder& intruder, const FacetCloud& exterior, int dim, double limit,
               std::vector<std::int32_t>& scratch) {
  const auto x = std::span(intruder.probe.place).first(dim);
  std::vector<std::pair<double, std::int32_t>> near;
  for (double radius = std::min(intruder.probe.size, limit);; radius = std::min(2.0 * radius, limit)) {
    Box box;
    box.include(x);
    box.inflate(radius);
    exterior.tree().query(box, scratch);
    near.clear();
    for (const std::int32_t f : scratch) {
      if (exterior.body(f) != intruder.inside) continue;
      const Projection projection = closest_point(exterior.type(f), exterior.positions(f), x);
      // Of its own body the facets that it lies on bound the outside from within.
      const bool is_own =
          intruder.inside == intruder.probe.body && projection.distance <= touching * intruder.probe.size;
      if (projection.found && !is_own && projection.distance <= radius) near.emplace_back(projection.distance, f);
    }
    if (!near.empty() || radius >= limit) break;
  }
  Depth result;
  for (const auto& [distance, f] : near)
    result.depth = std::min(result.depth, distance);
  for (const auto& [distance, f] :
       near) // facets that share the closest point: the largest counts, whatever their order
    if (distance <= result.depth + 1e-9 * intruder.probe.size)
      result.size = std::max({result.size, intruder.probe.size, exterior.facet_size(f)});
  return result;
}

/// Are there contact pairs whose surfaces belong to these two bodies? Indexed [a * bodies + b]. Collective.
std::vector<std::uint8_t> declared_bodies(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  const std::size_t bodies = mesh.bodies.size(), pairs = input.pairs.size();
  std::vector<std::uint8_t> on(2 * pairs * bodies, 0); // pair and side has facets on body
  const auto mark = [&](const std::string& surface, std::size_t row) {
    for (const std::int32_t body : mesh.surfaces.at(surface).bodies)
      on[row * bodies + body] = 1;
  };
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    mark(input.pairs[pair].slave, 2 * pair);
    if (const auto* master = std::get_if<std::string>(&input.pairs[pair].master)) mark(*master, 2 * pair + 1);
  }
  MPI_Allreduce(MPI_IN_PLACE, on.data(), static_cast<int>(on.size()), MPI_UINT8_T, MPI_MAX, mesh.comm);
  std::vector<std::uint8_t> declared(bodies * bodies, 0);
  for (std::size_t pair = 0; pair < pairs; ++pair)
    for (std::size_t a = 0; a < bodies; ++a)
      for (std::size_t b = 0; b < bodies; ++b)
        if (on[2 * pair * bodies + a] != 0 && on[(2 * pair + 1) * bodies + b] != 0)
          declared[a * bodies + b] = declared[b * bodies + a] = 1;
  return declared;
}

/// Depths of the intruders near the surface: exact where found. Collective.
std::vector<Depth> shallow_depths(const CertificateInput& input, std::span<const Intruder> intruders,
                                  const FacetCloud& exterior) {
  // Twice the tolerance: what is found nearby is surely settled, what is not has failed.
  const double relative_limit = 2.0 * input.tolerances.penetration;
  Box wanted;
  double largest = 0.0;
  for (const Intruder& intruder : intruders) {
    wanted.include(std::span(intruder.probe.place).first(input.mesh.dim));
    largest = std::max(largest, intruder.probe.size);
  }
  wanted.inflate(relative_limit * largest);
  const FacetCloud cloud = exterior.gathered(input.mesh.comm, wanted);
  std::vector<Depth> depths;
  std::vector<std::int32_t> scratch;
  for (const Intruder& intruder : intruders)
    depths.push_back(depth_of(intruder, cloud, input.mesh.dim, relative_limit * intruder.probe.size, scratch));
  return depths;
}

/// The intruders of all ranks that are deep inside, and their depths: a failed certificate, so the cost of telling
/// everything to everybody does not matter. Collective.
std::vector<Depth> deep_depths(const CertificateInput& input, std::vector<Intruder>& intruders,
                               const FacetCloud& exterior) {
  const Mesh& mesh = input.mesh;
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  std::vector<double> message;
  for (const Intruder& intruder : intruders) {
    pack(intruder.probe, message);
    message.push_back(intruder.inside);
  }
  const auto arrived = exchanged(mesh.comm, std::vector<std::vector<double>>(ranks, message));
  intruders.clear();
  for (std::size_t at = 0; at < arrived.size(); at += probe_length + 1)
    intruders.push_back({unpacked(std::span(arrived).subspan(at, probe_length)).front(),
                         static_cast<std::int32_t>(arrived[at + probe_length])});
  Box all;
  for (std::int32_t f = 0; f < exterior.size(); ++f)
    all.include(exterior.box(f));
  std::vector<Depth> result;
  std::vector<double> depths, sizes;
  std::vector<std::int32_t> scratch;
  for (const Intruder& intruder : intruders) {
    const double far = box_distance(all, std::span(intruder.probe.place).first(mesh.dim)) + all.diagonal();
    result.push_back(all.empty() ? Depth{} : depth_of(intruder, exterior, mesh.dim, far, scratch));
    depths.push_back(result.back().depth);
  }
  const int count = static_cast<int>(depths.size());
  MPI_Allreduce(MPI_IN_PLACE, depths.data(), count, MPI_DOUBLE, MPI_MIN, mesh.comm);
  for (int i = 0; i < count; ++i)
    sizes.push_back(result[i].depth == depths[i] ? result[i].size : 0.0);
  MPI_Allreduce(MPI_IN_PLACE, sizes.data(), count, MPI_DOUBLE, MPI_MAX, mesh.comm);
  for (int i = 0; i < count; ++i)
    result[i] = {depths[i], sizes[i]};
  return result;
}

/// Nodes inside rigid shapes. A plane bounds a half-space without end, which only the bodies it is declared with are
/// sure to mean; balls and cylinders are obstacles to everybody.
void look_into_shapes(const CertificateInput& input, std::span<const Probe> probes, Worst& worst) {
  const Mesh& mesh = input.mesh;
  for (const ContactPairNames& pair : input.pairs) {
    const auto* master = std::get_if<MovedShape>(&pair.master);
    if (master == nullptr) continue;
    std::vector<std::uint8_t> declared(mesh.bodies.size(), 0);
    for (const std::int32_t body : mesh.surfaces.at(pair.slave).bodies)
      declared[body] = 1;
    MPI_Allreduce(MPI_IN_PLACE, declared.data(), static_cast<int>(declared.size()), MPI_UINT8_T, MPI_MAX, mesh.comm);
    for (const Probe& probe : probes) {
      if (declared[probe.body] == 0 && std::holds_alternative<RigidPlane>(master->shape)) continue;
      const auto x = std::span(probe.place).first(mesh.dim);
      const double depth = -signed_distance(master->shape, master->shift, x).gap;
      if (depth <= 0.0) continue;
      worst.offer(depth / probe.size, [&] {
        return "body '" + mesh.bodies[probe.body] + "' inside the rigid master of pair '" + pair.name + "' at " +
               place_text(x);
      });
    }
  }
}

} // namespace

Worst check_overlap(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  const std::size_t bodies = mesh.bodies.size();
  const std::vector<Probe> mine = local_probes(input);
  Worst worst;
  look_into_shapes(input, mine, worst);
  if (bodies < 2 && !looks_into_own_body(input)) return over_ranks(mesh.comm, std::move(worst));

  const std::vector<std::uint8_t> declared = declared_bodies(input);
  const auto offer = [&](const Intruder& intruder, const Depth& depth) {
    worst.offer(depth.depth / depth.size, [&] {
      const auto& [probe, inside] = intruder;
      const bool known = declared[probe.body * bodies + inside] != 0;
      return "body '" + mesh.bodies[probe.body] + "' inside body '" + mesh.bodies[inside] + "' at " +
             place_text(std::span(probe.place).first(mesh.dim)) + ", " + (known ? "a" : "no") +
             " contact is declared " + (probe.body == inside ? "of it with itself" : "between them");
    });
  };
  const FacetCloud exterior = FacetCloud::local(mesh, input.displacement, mesh.exterior, Configuration::Current);
  const std::vector<Intruder> intruders = find_intruders(input, foreign_probes(input, mine));
  const std::vector<Depth> shallow = shallow_depths(input, intruders, exterior);
  std::vector<Intruder> deep;
  for (std::size_t i = 0; i < intruders.size(); ++i)
    if (shallow[i].depth < no_value)
      offer(intruders[i], shallow[i]);
    else
      deep.push_back(intruders[i]);
  const std::vector<Depth> depths = deep_depths(input, deep, exterior);
  for (std::size_t i = 0; i < deep.size(); ++i)
    offer(deep[i], depths[i]);
  return over_ranks(mesh.comm, std::move(worst));
}

} // namespace amontons::accuracy
