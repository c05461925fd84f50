// From gmsh's model to a RawMesh: groups, cells and the elements of lower groups, and the faults that only gmsh's own
// structure (entities, element types) shows.
#include "base/error.hpp"
#include "mesh/gmsh_session.hpp"
#include "mesh/raw_checks.hpp"

#include <algorithm>
#include <gmsh.h>
#include <limits>
#include <numeric>
#include <optional>

namespace amontons {
namespace {

using gmsh::vectorpair;

/// gmsh's number of a type of element, and how we hold it: `given` nodes are in the file, the rest is interpolated.
struct GmshType {
  ElementType type;
  int given;
};

std::optional<GmshType> known_type(int gmsh_type) {
  switch (gmsh_type) {
  case 1:
    return GmshType{ElementType::Segment2, 2};
  case 8:
    return GmshType{ElementType::Segment3, 3};
  case 2:
    return GmshType{ElementType::Triangle3, 3};
  case 9:
    return GmshType{ElementType::Triangle6, 6};
  case 3:
    return GmshType{ElementType::Quadrilateral4, 4};
  case 10:
    return GmshType{ElementType::Quadrilateral9, 9};
  case 16:
    return GmshType{ElementType::Quadrilateral9, 8};
  case 4:
    return GmshType{ElementType::Tetrahedron4, 4};
  case 11:
    return GmshType{ElementType::Tetrahedron10, 10};
  case 5:
    return GmshType{ElementType::Hexahedron8, 8};
  case 12:
    return GmshType{ElementType::Hexahedron27, 27};
  case 17:
    return GmshType{ElementType::Hexahedron27, 20};
  default:
    return std::nullopt;
  }
}

constexpr int gmsh_point = 15;

std::string type_name(int gmsh_type) {
  std::string name;
  int dim = 0, order = 0, nodes = 0, corners = 0;
  std::vector<double> local;
  gmsh::model::mesh::getElementProperties(gmsh_type, name, dim, order, nodes, local, corners);
  return name;
}

/// A physical group of gmsh and its place in RawMesh::groups.
using GroupIndex = std::map<std::pair<int, int>, std::int32_t>;

/// Reads one model; members are what the steps share.
class Reader {
 public:
  Reader(const std::string& file, Faults& faults) : file_("Mesh file '" + file + "'"), faults_(faults) {}

  RawMesh read(const DeclaredGroups& declared);
  const std::vector<std::size_t>& node_tags() const { return node_tags_; }

 private:
  void find_dimension();
  void read_groups(const DeclaredGroups& declared);
  std::vector<std::int32_t> groups_of_entity(int dim, int tag) const;
  void read_cells();
  void read_body_cells(int tag, std::int32_t body);
  void check_one_order();
  void number_nodes();
  void read_lower_elements();
  void read_lower_entity(int dim, int tag, const std::vector<std::int32_t>& groups);

  std::string file_;
  Faults& faults_;
  RawMesh raw_;
  GroupIndex group_index_;
  std::vector<std::size_t> node_tags_;                       // of each node of raw_; 0: made here
  std::unordered_map<std::size_t, std::int64_t> node_index_; // by gmsh's tag
  std::vector<std::int64_t> incomplete_;                     // cells that lack the nodes on face and cell middles
};

void Reader::find_dimension() {
  vectorpair entities;
  gmsh::model::getEntities(entities);
  for (const auto& [dim, tag] : entities) {
    std::vector<int> types;
    gmsh::model::mesh::getElementTypes(types, dim, tag);
    if (!types.empty()) raw_.dim = std::max(raw_.dim, dim);
  }
  if (raw_.dim < 2)
    throw UserError(file_ + " holds no surface or volume cells; mesh it up to dimension 2 or 3 and save all groups.");
}

void Reader::read_groups(const DeclaredGroups& declared) {
  vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  std::map<std::string, int> dim_of_name;
  for (const auto& [dim, tag] : groups) {
    std::string name;
    gmsh::model::getPhysicalName(dim, tag, name);
    if (name.empty() && dim == raw_.dim)
      faults_.push_back(file_ + ": the physical group " + std::to_string(tag) + " of dimension " + std::to_string(dim) +
                        " has no name; name every body, as in Physical " + (dim == 2 ? "Surface" : "Volume") +
                        "(\"block\") = {...};");
    if (name.empty()) name = std::to_string(tag);
    if (const auto [place, is_new] = dim_of_name.insert({name, dim}); !is_new)
      faults_.push_back(file_ + ": the name '" + name + "' belongs to two physical groups, of dimensions " +
                        std::to_string(place->second) + " and " + std::to_string(dim) +
                        "; a body or surface cannot mix them: give each group a name of its own.");
    group_index_[{dim, tag}] = static_cast<std::int32_t>(raw_.groups.size());
    raw_.groups.push_back({name, dim, 0});
  }
  for (const auto& [dim, name] : declared)
    if (!dim_of_name.contains(name)) raw_.groups.push_back({name, dim, 0}); // stays empty, and is complained of
}

std::vector<std::int32_t> Reader::groups_of_entity(int dim, int tag) const {
  std::vector<int> tags;
  gmsh::model::getPhysicalGroupsForEntity(dim, tag, tags);
  std::vector<std::int32_t> groups;
  for (const int group : tags)
    if (group != std::numeric_limits<int>::min()) // which is no group's number and has no absolute value
      groups.push_back(group_index_.at({dim, std::abs(group)}));
  return groups;
}

void Reader::read_cells() {
  vectorpair entities;
  gmsh::model::getEntities(entities, raw_.dim);
  std::size_t unnamed = 0, unnamed_entities = 0;
  for (const auto& [dim, tag] : entities) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> tags, nodes;
    gmsh::model::mesh::getElements(types, tags, nodes, dim, tag);
    if (types.empty()) continue;
    const auto bodies = groups_of_entity(dim, tag);
    if (bodies.empty()) {
      for (const auto& of_type : tags)
        unnamed += of_type.size();
      ++unnamed_entities;
      continue;
    }
    for (std::size_t other = 1; other < bodies.size(); ++other)
      ++raw_.groups[bodies[other]].num_elements; // not empty
    if (bodies.size() > 1)
      faults_.push_back(file_ + ": the cells of " + (dim == 2 ? "surface " : "volume ") + std::to_string(tag) +
                        " are in two bodies, '" + raw_.groups[bodies[0]].name + "' and '" +
                        raw_.groups[bodies[1]].name +
                        "'; keep each in one physical group (in a .msh: give each body "
                        "elementary tags of its own).");
    read_body_cells(tag, bodies.front());
  }
  if (unnamed > 0)
    faults_.push_back(file_ + ": cells in no physical group: " + std::to_string(unnamed) + " (surfaces or volumes: " +
                      std::to_string(unnamed_entities) + "); put every part into a named body, as in Physical " +
                      (raw_.dim == 2 ? "Surface" : "Volume") + "(\"block\") = {...};");
}

void Reader::read_body_cells(int tag, std::int32_t body) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, raw_.dim, tag);
  for (std::size_t i = 0; i < types.size(); ++i) {
    const auto known = known_type(types[i]);
    raw_.groups[body].num_elements += static_cast<std::int64_t>(tags[i].size());
    if (!known) {
      faults_.push_back(file_ + ": cells of the type " + type_name(types[i]) + " in body '" + raw_.groups[body].name +
                        "': " + std::to_string(tags[i].size()) +
                        "; use triangles and quadrilaterals, or tetrahedra and hexahedra, of order 1 or 2.");
      continue;
    }
    const std::size_t held = num_nodes(known->type), given = known->given;
    for (std::size_t cell = 0; cell < tags[i].size(); ++cell) {
      if (given < held) incomplete_.push_back(raw_.num_cells());
      raw_.cell_types.push_back(known->type);
      raw_.cell_bodies.push_back(body);
      for (std::size_t a = 0; a < held; ++a)
        raw_.cell_nodes.push_back(a < given ? static_cast<std::int64_t>(nodes[i][cell * given + a]) : -1);
      raw_.cell_offsets.push_back(static_cast<std::int64_t>(raw_.cell_nodes.size()));
    }
  }
}

void Reader::check_one_order() {
  std::array<std::int64_t, 3> cells{};
  for (const auto type : raw_.cell_types)
    ++cells[element_order(type)];
  raw_.order = cells[2] > 0 ? 2 : 1;
  if (cells[1] > 0 && cells[2] > 0)
    faults_.push_back(file_ + " mixes cells of order 1 (" + std::to_string(cells[1]) + ") with cells of order 2 (" +
                      std::to_string(cells[2]) + "); give mesh: order to bring all to one.");
}

/// Numbers the nodes of cells in the order of gmsh's tags and replaces tags by these numbers.
void Reader::number_nodes() {
  std::vector<std::size_t> tags;
  std::vector<double> places, parametric;
  gmsh::model::mesh::getNodes(tags, places, parametric);
  std::unordered_map<std::size_t, std::size_t> position;
  position.reserve(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i)
    position.emplace(tags[i], i);
  std::vector<bool> used(tags.size(), false);
  for (auto& node : raw_.cell_nodes)
    if (node >= 0) used[node = static_cast<std::int64_t>(position.at(static_cast<std::size_t>(node)))] = true;
  std::vector<std::size_t> order(tags.size());
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](std::size_t i) { return !used[i]; });
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return tags[i] < tags[j]; });
  std::vector<std::int64_t> number(tags.size(), -1);
  for (const auto i : order) {
    number[i] = static_cast<std::int64_t>(node_tags_.size());
    node_index_.emplace(tags[i], number[i]);
    node_tags_.push_back(tags[i]);
    raw_.coordinates.insert(raw_.coordinates.end(), places.begin() + 3 * i, places.begin() + 3 * i + 3);
  }
  for (auto& node : raw_.cell_nodes)
    if (node >= 0) node = number[node];
}

/// Adds the nodes on the middles of faces and cells that serendipity elements (8 and 20 nodes) lack, where their own
/// interpolation puts them: a face's middle is half the sum of its 4 edge middles less a quarter of the sum of its
/// corners, a hexahedron's a quarter of the sum of its 12 edge middles less a quarter of the sum of its 8 corners.
void complete_serendipity(RawMesh& raw, const std::vector<std::int64_t>& cells, std::vector<std::size_t>& node_tags) {
  std::unordered_map<CornerSet<8>, std::int64_t, CornerSetHash> made;
  for (const auto cell : cells) {
    const auto& supports = topology(raw.cell_types[cell]).supports;
    auto* nodes = &raw.cell_nodes[raw.cell_offsets[cell]];
    for (std::size_t a = 0; a < supports.size(); ++a) {
      if (nodes[a] >= 0) continue;
      const auto& support = supports[a];
      std::vector<std::int64_t> corners;
      for (const int corner : support)
        corners.push_back(nodes[corner]);
      const auto [entry, is_new] =
          made.try_emplace(corner_set<8>(corners), static_cast<std::int64_t>(node_tags.size()));
      nodes[a] = entry->second;
      if (!is_new) continue;
      std::array<double, 3> place{};
      const auto add = [&](std::int64_t node, double weight) {
        for (int i = 0; i < 3; ++i)
          place[i] += weight * raw.coordinates[3 * node + i];
      };
      for (const auto corner : corners)
        add(corner, -0.25);
      for (std::size_t b = 0; b < supports.size(); ++b)
        if (supports[b].size() == 2 &&
            std::includes(support.begin(), support.end(), supports[b].begin(), supports[b].end()))
          add(nodes[b], support.size() == 4 ? 0.5 : 0.25);
      raw.coordinates.insert(raw.coordinates.end(), place.begin(), place.end());
      node_tags.push_back(0);
    }
  }
}

void Reader::read_lower_elements() {
  vectorpair entities;
  gmsh::model::getEntities(entities);
  for (const auto& [dim, tag] : entities)
    if (dim < raw_.dim)
      if (const auto groups = groups_of_entity(dim, tag); !groups.empty()) read_lower_entity(dim, tag, groups);
}

void Reader::read_lower_entity(int dim, int tag, const std::vector<std::int32_t>& groups) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, dim, tag);
  for (std::size_t i = 0; i < types.size(); ++i) {
    const auto known = types[i] == gmsh_point ? GmshType{ElementType::Segment2, 1} : known_type(types[i]);
    if (!known) {
      faults_.push_back(file_ + ": elements of the type " + type_name(types[i]) + " in physical group '" +
                        raw_.groups[groups.front()].name + "': " + std::to_string(tags[i].size()) +
                        "; use segments, triangles and quadrilaterals of order 1 or 2.");
      continue;
    }
    const std::size_t given = known->given;
    const std::size_t corners = dim == 0 ? 1 : num_vertices(known->type);
    for (std::size_t element = 0; element < tags[i].size(); ++element) {
      RawMesh::Sub sub{{}, known->type, -1};
      if (dim > 0) sub.type = element_type(dim, static_cast<int>(corners), 1);
      for (std::size_t a = 0; a < corners; ++a) {
        const auto found = node_index_.find(nodes[i][element * given + a]);
        sub.nodes.push_back(found == node_index_.end() ? -1 : found->second);
      }
      for (const auto group : groups) {
        sub.group = group;
        ++raw_.groups[group].num_elements;
        raw_.subs.push_back(sub);
      }
    }
  }
}

RawMesh Reader::read(const DeclaredGroups& declared) {
  find_dimension();
  read_groups(declared);
  read_cells();
  check_one_order();
  number_nodes();
  complete_serendipity(raw_, incomplete_, node_tags_);
  read_lower_elements();
  for (const auto& group : raw_.groups)
    if (group.num_elements == 0)
      faults_.push_back(file_ + ": physical group '" + group.name + "' of dimension " + std::to_string(group.dim) +
                        " has no elements; let it name entities that exist and are meshed, or remove it.");
  return std::move(raw_);
}

} // namespace

std::vector<std::string> RawMesh::group_names(int of_dim) const {
  std::vector<std::string> names;
  for (const auto& group : groups)
    if (of_dim < 0 || group.dim == of_dim) names.push_back(group.name);
  std::sort(names.begin(), names.end());
  return names;
}

RawMesh read_mesh(const MeshSource& source) {
  GmshSession session(source.parameters);
  const auto declared = load_model(session, source);
  Faults faults;
  Reader reader(source.file, faults);
  auto raw = reader.read(declared);
  // Shapes mean something only where every cell has been understood.
  if (faults.empty()) {
    orient_and_check_cells(raw, reader.node_tags(), faults);
    check_lower_groups(raw, reader.node_tags(), faults);
    for (auto& fault : faults)
      fault = "Mesh file '" + source.file + "': " + fault;
  }
  if (!faults.empty()) throw UserError(faults);
  return raw;
}

} // namespace amontons
