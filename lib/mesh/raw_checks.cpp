#include "mesh/raw_checks.hpp"

#include "base/error.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace amontons {
namespace {

std::span<const std::int64_t> cell_nodes(const RawMesh& raw, std::int64_t cell) {
  return std::span(raw.cell_nodes).subspan(raw.cell_offsets[cell], raw.cell_offsets[cell + 1] - raw.cell_offsets[cell]);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// dN_a/dξ_i at the corners and at the quadrature points: the places where a cell's Jacobian is looked at.
struct JacobianProbe {
  int size = 0;
  std::vector<Eigen::MatrixXd> gradients; // num_nodes x dim each
};

JacobianProbe jacobian_probe(ElementType type) {
  const int dim = element_dim(type), nodes = num_nodes(type), corners = num_vertices(type);
  const auto& rule = quadrature(type, element_order(type) == 1 ? 2 : 4);
  const bool constant = corners == dim + 1 && element_order(type) == 1;
  JacobianProbe probe;
  probe.size = constant ? 1 : corners + rule.size();
  std::vector<double> gradient(std::size_t(nodes) * dim);
  for (int i = 0; i < probe.size; ++i) {
    const auto xi = i < corners ? reference_nodes(type).subspan(std::size_t(i) * dim, dim) : rule.point(i - corners);
    shape_gradients(type, xi, gradient);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    probe.gradients.push_back(Eigen::Map<const RowMajor>(gradient.data(), nodes, dim));
  }
  return probe;
}

enum class Shape { Good, Reversed, Inverted, Degenerate };

/// By the determinants of dx/dξ, made dimensionless with the largest distance of a node from the first.
template <int dim>
Shape cell_shape(const RawMesh& raw, std::span<const std::int64_t> nodes, const JacobianProbe& probe) {
  Eigen::Matrix<double, dim, Eigen::Dynamic, 0, dim, 27> places(dim, nodes.size());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    places.col(a) = Eigen::Map<const Eigen::Matrix<double, dim, 1>>(&raw.coordinates[3 * nodes[a]]);
  places.colwise() -= Eigen::Matrix<double, dim, 1>(places.col(0));
  const double size = std::sqrt(places.colwise().squaredNorm().maxCoeff());
  double smallest = std::numeric_limits<double>::max(), largest = -smallest;
  for (const auto& gradient : probe.gradients) {
    const Eigen::Matrix<double, dim, dim> jacobian = places * gradient;
    const double determinant = jacobian.determinant();
    smallest = std::min(smallest, determinant);
    largest = std::max(largest, determinant);
  }
  const double nothing = 1e-12 * std::pow(size, dim);
  if (smallest > nothing) return Shape::Good;
  if (largest < -nothing) return Shape::Reversed;
  return smallest < -nothing && largest > nothing ? Shape::Inverted : Shape::Degenerate;
}

void turn_round(RawMesh& raw, std::int64_t cell) {
  const auto old = cell_nodes(raw, cell);
  const std::vector<std::int64_t> kept(old.begin(), old.end());
  const auto& mirror = topology(raw.cell_types[cell]).mirror;
  for (std::size_t a = 0; a < kept.size(); ++a)
    raw.cell_nodes[raw.cell_offsets[cell] + a] = kept[mirror[a]];
}

/// How many cells (or other elements) of a kind there are, the first and the last of them.
struct Tally {
  std::int64_t count = 0;
  std::int64_t first = -1, last = -1;
  void add(std::int64_t cell) {
    if (count++ == 0) first = cell;
    last = cell;
  }
};

/// "3, the first at nodes 1, 2 and 5 near (1, 0, 0) in body 'block'".
std::string counted(const RawMesh& raw, const Tally& cells, const std::vector<std::size_t>& node_tags) {
  return std::to_string(cells.count) + ", the first at " +
         element_place(raw, cell_nodes(raw, cells.first).first(num_vertices(raw.cell_types[cells.first])), node_tags) +
         " in body '" + raw.groups[raw.cell_bodies[cells.first]].name + "'";
}

void check_shapes(RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  std::map<ElementType, JacobianProbe> probes;
  Tally inverted, degenerate;
  for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell) {
    const auto type = raw.cell_types[cell];
    auto& probe = probes[type];
    if (probe.size == 0) probe = jacobian_probe(type);
    const auto nodes = cell_nodes(raw, cell);
    const Shape shape = raw.dim == 2 ? cell_shape<2>(raw, nodes, probe) : cell_shape<3>(raw, nodes, probe);
    if (shape == Shape::Reversed) turn_round(raw, cell);
    if (shape == Shape::Inverted) inverted.add(cell);
    if (shape == Shape::Degenerate) degenerate.add(cell);
  }
  if (inverted.count > 0)
    faults.push_back("inverted cells (their Jacobian changes sign): " + counted(raw, inverted, node_tags) +
                     "; mend the first's shape, or for order 2 on a curved boundary refine the mesh there.");
  if (degenerate.count > 0)
    faults.push_back("degenerate cells (no area or volume): " + counted(raw, degenerate, node_tags) +
                     "; remove them, or mesh again with another element size.");
}

void check_doubled_cells(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  std::unordered_map<CornerSet<8>, std::int64_t, CornerSetHash> seen;
  seen.reserve(raw.num_cells());
  Tally doubled;
  std::int64_t partner = -1;
  for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell) {
    const auto corners = cell_nodes(raw, cell).first(num_vertices(raw.cell_types[cell]));
    const auto [place, is_new] = seen.try_emplace(corner_set<8>(corners), cell);
    if (is_new) continue;
    if (doubled.count == 0) partner = place->second;
    doubled.add(cell);
  }
  if (doubled.count == 0) return;
  const auto& body = raw.groups[raw.cell_bodies[doubled.first]].name;
  const auto& other = raw.groups[raw.cell_bodies[partner]].name;
  faults.push_back("cells that are there twice: " + counted(raw, doubled, node_tags) +
                   (body == other ? "" : " and also in body '" + other + "'") +
                   "; each cell must be in one body once: check the physical groups.");
}

/// Facets with three or more cells, found as equal hashes of their corners.
void check_overlaps(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  const auto for_facets = [&](auto&& visit) {
    for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell)
      for (const auto& facet : topology(raw.cell_types[cell]).facets) {
        std::array<std::int64_t, 4> corners{};
        std::size_t count = 0;
        for (const int corner : facet.corners())
          corners[count++] = cell_nodes(raw, cell)[corner];
        visit(cell, CornerSetHash{}(corner_set<4>(std::span(corners).first(count))));
      }
  };
  std::vector<std::size_t> hashes;
  for_facets([&](std::int64_t, std::size_t hash) { hashes.push_back(hash); });
  std::sort(hashes.begin(), hashes.end());
  std::set<std::size_t> crowded;
  for (std::size_t i = 2; i < hashes.size(); ++i)
    if (hashes[i] == hashes[i - 2]) crowded.insert(hashes[i]);
  if (crowded.empty()) return;
  Tally cells;
  for_facets([&](std::int64_t cell, std::size_t hash) {
    if (crowded.contains(hash) && cells.last != cell) cells.add(cell);
  });
  faults.push_back("cells that overlap (three or more share a facet): " + counted(raw, cells, node_tags) +
                   "; mesh the bodies again.");
}

void check_plane(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  double size = 0.0;
  for (const double x : raw.coordinates)
    size = std::max(size, std::abs(x));
  for (std::size_t node = 0; node < raw.coordinates.size() / 3; ++node) {
    if (std::abs(raw.coordinates[3 * node + 2]) <= 1e-9 * size) continue;
    const std::int64_t index = static_cast<std::int64_t>(node);
    faults.push_back("the mesh has no volume cells, and its surface leaves the plane z = 0, first at " +
                     element_place(raw, std::span(&index, 1), node_tags) +
                     "; put a plane mesh at z = 0, or give physical volumes for a solid.");
    return;
  }
}

/// A fault for each group that has elements for which `is_wrong` holds.
template <class IsWrong>
void check_subs(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults,
                const std::string& complaint, IsWrong&& is_wrong) {
  std::vector<Tally> wrong(raw.groups.size());
  for (std::size_t s = 0; s < raw.subs.size(); ++s)
    if (is_wrong(raw.subs[s])) wrong[raw.subs[s].group].add(static_cast<std::int64_t>(s));
  for (std::size_t g = 0; g < wrong.size(); ++g) {
    if (wrong[g].count == 0) continue;
    const auto place = element_place(raw, raw.subs[wrong[g].first].nodes, node_tags);
    faults.push_back("physical group '" + raw.groups[g].name + "': " + std::to_string(wrong[g].count) + " of its " +
                     std::to_string(raw.groups[g].num_elements) + " elements " + complaint +
                     (place.empty() ? "." : " (the first at " + place + ")."));
  }
}

} // namespace

FacetUses group_facet_uses(const RawMesh& raw) {
  FacetUses uses;
  std::vector<bool> marked(raw.coordinates.size() / 3, false);
  for (const auto& sub : raw.subs) {
    if (raw.groups[sub.group].dim != raw.dim - 1) continue;
    uses.try_emplace(corner_set<4>(sub.nodes));
    for (const auto node : sub.nodes)
      if (node >= 0) marked[node] = true;
  }
  for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell) {
    const auto nodes = cell_nodes(raw, cell);
    for (const auto& facet : topology(raw.cell_types[cell]).facets) {
      std::array<std::int64_t, 4> corners;
      int count = 0;
      for (const int corner : facet.corners())
        if (marked[nodes[corner]]) corners[count++] = nodes[corner];
      if (count < num_vertices(facet.type)) continue;
      const auto found = uses.find(corner_set<4>(std::span(corners).first(count)));
      if (found == uses.end()) continue;
      if (found->second.count < 2) found->second.cells[found->second.count] = cell;
      ++found->second.count;
    }
  }
  return uses;
}

std::string element_place(const RawMesh& raw, std::span<const std::int64_t> nodes,
                          const std::vector<std::size_t>& node_tags) {
  std::vector<std::string> names;
  std::array<double, 3> centre{};
  std::int64_t known = 0;
  for (const auto node : nodes) {
    if (node < 0) continue;
    ++known;
    if (node_tags[node] > 0) names.push_back(std::to_string(node_tags[node]));
    for (int i = 0; i < 3; ++i)
      centre[i] += raw.coordinates[3 * node + i];
  }
  if (known == 0) return {};
  for (double& x : centre)
    x /= static_cast<double>(known);
  const std::string named =
      names.empty() ? "" : (names.size() == 1 ? "node " : "nodes ") + join_names(names) + " near ";
  return named + "(" + number(centre[0]) + ", " + number(centre[1]) + ", " + number(centre[2]) + ")";
}

void orient_and_check_cells(RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  const auto before = faults.size();
  if (raw.dim == 2) check_plane(raw, node_tags, faults);
  if (faults.size() > before) return; // areas in the plane would mean nothing
  check_shapes(raw, node_tags, faults);
  const auto good = faults.size();
  check_doubled_cells(raw, node_tags, faults);
  if (faults.size() == good) check_overlaps(raw, node_tags, faults); // doubled cells overlap, too
}

void check_lower_groups(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults) {
  const auto uses = group_facet_uses(raw);
  check_subs(raw, node_tags, faults,
             std::string("are not facets of any cell: a surface group must lie on cells of one body and share their "
                         "nodes (") +
                 (raw.dim == 2 ? "curves on surfaces" : "surfaces on volumes") + "); attach or remove them",
             [&](const RawMesh::Sub& sub) {
               return raw.groups[sub.group].dim == raw.dim - 1 && uses.at(corner_set<4>(sub.nodes)).count == 0;
             });
  check_subs(raw, node_tags, faults, "have nodes that no cell has; make them share nodes with a body or remove them",
             [&](const RawMesh::Sub& sub) {
               return raw.groups[sub.group].dim < raw.dim - 1 &&
                      std::any_of(sub.nodes.begin(), sub.nodes.end(), [](std::int64_t node) { return node < 0; });
             });
}

void check_boundary_groups(const RawMesh& raw, const std::vector<std::string>& names) {
  const auto uses = group_facet_uses(raw);
  const std::vector<std::size_t> no_tags(raw.coordinates.size() / 3, 0);
  const std::set<std::string> wanted(names.begin(), names.end());
  Faults faults;
  check_subs(raw, no_tags, faults,
             "lie inside a body or between bodies that share nodes; a surface that is loaded or in contact must be on "
             "the outside: give the two sides nodes of their own",
             [&](const RawMesh::Sub& sub) {
               const auto& group = raw.groups[sub.group];
               return group.dim == raw.dim - 1 && wanted.contains(group.name) &&
                      uses.at(corner_set<4>(sub.nodes)).count != 1;
             });
  for (const auto& name : wanted) {
    const auto group =
        std::find_if(raw.groups.begin(), raw.groups.end(), [&](const auto& g) { return g.name == name; });
    if (group == raw.groups.end())
      faults.push_back("the mesh has no physical group '" + name + "'; it has " + join_names(raw.group_names(-1)) +
                       ".");
    else if (group->dim != raw.dim - 1)
      faults.push_back("physical group '" + name + "' has dimension " + std::to_string(group->dim) +
                       "; a surface that is loaded or in contact needs dimension " + std::to_string(raw.dim - 1) + ".");
  }
  if (!faults.empty()) throw UserError(faults);
}

} // namespace amontons
