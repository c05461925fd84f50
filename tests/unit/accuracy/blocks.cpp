#include "blocks.hpp"

#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

namespace amontons::testing {

namespace {

/// The whole mesh, the same on every rank.
struct Whole {
  std::vector<std::array<double, 3>> nodes;
  struct Cell {
    int body;
    std::vector<int> nodes;
    std::vector<std::pair<std::string, std::vector<int>>> facets; // boundary facets: surface, nodes
  };
  std::vector<Cell> cells;
};

struct Side {
  const char* suffix;
  int axis;
  bool high;
  std::vector<int> corners; // of the cell, outward
};

const std::vector<Side>& sides(int dim) {
  static const std::vector<Side> square = {{"_bottom", 1, false, {0, 1}},
                                           {"_sides", 0, true, {1, 2}},
                                           {"_top", 1, true, {2, 3}},
                                           {"_sides", 0, false, {3, 0}}};
  static const std::vector<Side> cube = {{"_bottom", 2, false, {0, 3, 2, 1}}, {"_top", 2, true, {4, 5, 6, 7}},
                                         {"_sides", 1, false, {0, 1, 5, 4}},  {"_sides", 0, true, {1, 2, 6, 5}},
                                         {"_sides", 1, true, {2, 3, 7, 6}},   {"_sides", 0, false, {3, 0, 4, 7}}};
  return dim == 2 ? square : cube;
}

Whole whole_mesh(int dim, const std::vector<Block>& blocks, bool welded) {
  static const int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  Whole whole;
  std::map<std::tuple<int, long, long, long>, int> numbers;
  for (int body = 0; body < static_cast<int>(blocks.size()); ++body) {
    const Block& block = blocks[body];
    const auto node_at = [&](const std::array<int, 3>& index) {
      std::array<double, 3> x{};
      for (int c = 0; c < dim; ++c)
        x[c] = block.low[c] + (block.high[c] - block.low[c]) * index[c] / block.cells[c];
      const auto rounded = [&](int c) { return std::lround(1e6 * x[c]); };
      const auto [it, fresh] =
          numbers.emplace(std::tuple(welded ? 0 : body, rounded(0), rounded(1), rounded(2)), whole.nodes.size());
      if (fresh) whole.nodes.push_back(x);
      return it->second;
    };
    const int layers = dim == 3 ? block.cells[2] : 1;
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j < block.cells[1]; ++j)
        for (int i = 0; i < block.cells[0]; ++i) {
          Whole::Cell cell{body, {}, {}};
          for (int a = 0; a < (dim == 2 ? 4 : 8); ++a)
            cell.nodes.push_back(node_at({i + corner[a][0], j + corner[a][1], k + corner[a][2]}));
          const std::array<int, 3> at{i, j, k};
          for (const Side& side : sides(dim)) {
            if (at[side.axis] != (side.high ? block.cells[side.axis] - 1 : 0)) continue;
            std::vector<int> facet;
            for (const int a : side.corners)
              facet.push_back(cell.nodes[a]);
            cell.facets.emplace_back(block.name + side.suffix, facet);
          }
          whole.cells.push_back(cell);
        }
  }
  return whole;
}

void add_facet(FacetSet& set, int dim, int body, const std::vector<std::int32_t>& nodes) {
  set.types.push_back(dim == 2 ? ElementType::Segment2 : ElementType::Quadrilateral4);
  set.nodes.insert(set.nodes.end(), nodes.begin(), nodes.end());
  set.offsets.push_back(static_cast<std::int32_t>(set.nodes.size()));
  set.bodies.push_back(body);
}

} // namespace

Mesh block_mesh(MPI_Comm comm, int dim, const std::vector<Block>& blocks, bool welded) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const Whole whole = whole_mesh(dim, blocks, welded);
  // A node belongs to the lowest rank that has a cell with it.
  std::vector<int> owner(whole.nodes.size(), ranks);
  for (std::size_t c = 0; c < whole.cells.size(); ++c)
    for (const int node : whole.cells[c].nodes)
      owner[node] = std::min(owner[node], static_cast<int>(c % ranks));
  std::vector<std::int64_t> global(whole.nodes.size());
  std::int64_t next = 0;
  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = dim;
  for (int r = 0; r < ranks; ++r) {
    if (r == rank) mesh.first_global = next;
    for (std::size_t node = 0; node < owner.size(); ++node)
      if (owner[node] == r) global[node] = next++;
  }
  mesh.num_global = next;

  std::set<int> ghosts;
  for (std::size_t c = rank; c < whole.cells.size(); c += ranks)
    for (const int node : whole.cells[c].nodes)
      if (owner[node] != rank) ghosts.insert(node);
  std::map<int, std::int32_t> local;
  const auto add_node = [&](int node) {
    local[node] = static_cast<std::int32_t>(local.size());
    mesh.coordinates.insert(mesh.coordinates.end(), whole.nodes[node].begin(), whole.nodes[node].begin() + dim);
    mesh.is_vertex.push_back(1);
    mesh.keys.push_back(node);
  };
  for (int node = 0; node < static_cast<int>(owner.size()); ++node)
    if (owner[node] == rank) add_node(node);
  mesh.num_owned = static_cast<std::int32_t>(local.size());
  for (const int node : ghosts) {
    add_node(node);
    mesh.ghost_globals.push_back(global[node]);
    mesh.ghost_owners.push_back(owner[node]);
  }

  for (const Block& block : blocks) {
    mesh.bodies.push_back(block.name);
    for (const Side& side : sides(dim))
      mesh.surfaces[block.name + side.suffix];
  }
  for (int body = 0; body < static_cast<int>(blocks.size()); ++body)
    mesh.blocks.push_back({dim == 2 ? ElementType::Quadrilateral4 : ElementType::Hexahedron8, body, {}});
  for (std::size_t c = rank; c < whole.cells.size(); c += ranks) {
    const auto& cell = whole.cells[c];
    for (const int node : cell.nodes)
      mesh.blocks[cell.body].nodes.push_back(local[node]);
    for (const auto& [surface, nodes] : cell.facets) {
      std::vector<std::int32_t> numbers;
      for (const int node : nodes)
        numbers.push_back(local[node]);
      add_facet(mesh.surfaces[surface], dim, cell.body, numbers);
      add_facet(mesh.exterior, dim, cell.body, numbers);
    }
  }
  return mesh;
}

Certificate Case::certify() const {
  return amontons::certify({.mesh = mesh,
                            .space = space,
                            .displacement = displacement,
                            .increment = displacement,
                            .pairs = pairs,
                            .samples = samples,
                            .external_forces = external,
                            .supports = supports,
                            .energy = energy,
                            .tolerances = {},
                            .force_floor = force_floor,
                            .kinematics = kinematics});
}

void displace(Case& scene, const Field& u) {
  const Mesh& mesh = scene.mesh;
  scene.displacement.assign(std::size_t(mesh.num_local()) * mesh.dim, 0.0);
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    std::array<double, 3> x{};
    std::copy_n(mesh.position(node).begin(), mesh.dim, x.begin());
    const auto moved = u(x);
    std::copy_n(moved.begin(), mesh.dim, scene.displacement.begin() + std::ptrdiff_t(node) * mesh.dim);
  }
}

namespace {

/// Visits the quadrature points of a surface: facet, ξ, shape values, X, weight x measure.
template <class Visit>
void visit_points(const Mesh& mesh, const FacetSet& set, Visit&& visit) {
  for (std::int32_t f = 0; f < set.size(); ++f) {
    const auto nodes = set.facet(f);
    std::vector<double> positions;
    for (const auto node : nodes)
      positions.insert(positions.end(), mesh.position(node).begin(), mesh.position(node).end());
    const Tabulation& table = tabulation(set.types[f], 3);
    for (int q = 0; q < table.rule->size(); ++q) {
      std::array<double, 3> x{}, normal;
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int c = 0; c < mesh.dim; ++c)
          x[c] += table.value(q)[a] * positions[a * mesh.dim + c];
      const double measure = facet_normal(set.types[f], positions, table.rule->point(q), normal);
      visit(f, table.rule->point(q), table.value(q), x, table.rule->weights[q] * measure,
            facet_size(set.types[f], positions));
    }
  }
}

} // namespace

void load(Case& scene, const std::string& surface, const std::array<double, 3>& traction) {
  const Mesh& mesh = scene.mesh;
  scene.external.resize(std::size_t(mesh.num_local()) * mesh.dim, 0.0);
  const FacetSet& set = mesh.surfaces.at(surface);
  visit_points(mesh, set, [&](std::int32_t f, auto, std::span<const double> shape, const auto&, double weight, double) {
    for (std::size_t a = 0; a < shape.size(); ++a)
      for (int c = 0; c < mesh.dim; ++c)
        scene.external[std::size_t(set.facet(f)[a]) * mesh.dim + c] += weight * shape[a] * traction[c];
  });
}

ContactSamples uniform_samples(const Mesh& mesh, const std::string& slave, double pressure,
                               const std::array<double, 3>& normal) {
  ContactSamples samples;
  const FacetSet& set = mesh.surfaces.at(slave);
  visit_points(mesh, set,
               [&](std::int32_t f, std::span<const double> xi, auto, const auto& x, double weight, double size) {
                 samples.facet.push_back(f);
                 samples.xi.push_back({xi[0], xi.size() > 1 ? xi[1] : 0.0});
                 samples.place.push_back(x);
                 samples.normal.push_back(normal);
                 samples.weight.push_back(weight);
                 samples.facet_size.push_back(size);
                 samples.pressure.push_back(pressure);
                 samples.gap.push_back(0.0);
                 samples.status.push_back(pressure > 0.0 ? ContactStatus::Slip : ContactStatus::Open);
               });
  std::set<std::int32_t> nodes(set.nodes.begin(), set.nodes.end());
  for (const std::int32_t node : nodes) {
    if (node >= mesh.num_owned) continue;
    samples.nodes.push_back(node);
    samples.nodal_pressure.push_back(pressure);
  }
  return samples;
}

Case compressed_blocks(MPI_Comm comm, int dim) {
  Case scene;
  std::array<double, 3> up{};
  up[dim - 1] = 1.0;
  std::array<double, 3> high_low = {1, 1, 1}, low_high = up, high_high = {1, 1, 1};
  high_high[dim - 1] = 2.0;
  scene.mesh =
      block_mesh(comm, dim, {{"lower", {0, 0, 0}, high_low, {3, 3, 3}}, {"upper", low_high, high_high, {2, 2, 2}}});
  scene.space = dim == 2 ? Space::PlaneStress : Space::Solid;
  displace(scene, [&](const auto& x) {
    std::array<double, 3> u{};
    u[dim - 1] = -0.01 * x[dim - 1];
    return u;
  });
  std::array<double, 3> down{};
  down[dim - 1] = -1.0;
  load(scene, "upper_top", down);
  load(scene, "lower_bottom", up);
  scene.pairs = {{"interface", "upper_bottom", "lower_top"}};
  scene.samples = {uniform_samples(scene.mesh, "upper_bottom", 1.0, up)};
  // Two unit volumes, energy density 1/2 x 1 x 0.01; the force grew in proportion to the displacement.
  scene.energy = {.stored = 0.01,
                  .external_work = 0.01,
                  .work_uncertainty = 0.0,
                  .virtual_work_defect = 0.0,
                  .virtual_work_scale = 0.04};
  return scene;
}

Case stretched_block(MPI_Comm comm, int dim) {
  Case scene = compressed_blocks(comm, dim);
  const double stretch = 0.02;
  displace(scene, [&](const auto& x) {
    std::array<double, 3> u{};
    u[dim - 1] = -0.01 * x[dim - 1];
    return u;
  });
  std::set<std::int32_t> of_upper;
  for (const auto& block : scene.mesh.blocks)
    if (block.body == 1) of_upper.insert(block.nodes.begin(), block.nodes.end());
  for (const std::int32_t node : of_upper)
    scene.displacement[std::size_t(node) * dim] += stretch * (scene.mesh.position(node)[0] - 0.5);
  scene.pairs[0].friction = Coulomb{.mu = 0.3};
  ContactSamples& samples = scene.samples[0];
  samples.has_friction = true;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double slip = stretch * (samples.place[i][0] - 0.5);
    samples.shear.push_back({slip > 0.0 ? -0.3 : 0.3, 0.0, 0.0});
    samples.slip.push_back({slip, 0.0, 0.0});
    samples.accumulated_slip.push_back(std::abs(slip));
    samples.tau_c.push_back(0.3);
    samples.friction_context.push_back({.dt = 1.0, .factor = 1.0, .new_contact = true});
    samples.friction_state_old.push_back({});
  }
  return scene;
}

const Certificate::Item& item(const Certificate& certificate, const std::string& name) {
  for (const auto& candidate : certificate.items)
    if (candidate.name == name) return candidate;
  throw std::out_of_range("no certificate item " + name);
}

std::vector<std::string> failures(const Certificate& certificate) {
  std::vector<std::string> names;
  for (const auto& candidate : certificate.items)
    if (!candidate.passed) names.push_back(candidate.name);
  return names;
}

} // namespace amontons::testing
