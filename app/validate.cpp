#include "validate.hpp"

#include "base/error.hpp"
#include "deck/shape.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

namespace amontons {

namespace {

const char* const axes[] = {"x", "y", "z"};

const char* group_kind(int dim) {
  const char* const kinds[] = {"points", "curves", "surfaces", "volumes"};
  return kinds[dim];
}

/// The deck, the mesh and the messages so far.
struct Fit {
  const Deck& deck;
  const RawMesh& raw;
  std::vector<std::string> messages = {};

  void fail(const Place& place, const std::string& message) { messages.push_back(place.text() + ": " + message); }

  bool has_group(const std::string& name, int dim) const {
    return std::any_of(raw.groups.begin(), raw.groups.end(),
                       [&](const auto& group) { return group.name == name && group.dim == dim; });
  }
  std::vector<int> dims_of_group(const std::string& name) const {
    std::vector<int> dims;
    for (const auto& group : raw.groups)
      if (group.name == name) dims.push_back(group.dim);
    return dims;
  }

  /// Notes that there is no such group; dim < 0: of any dimension.
  void fail_missing(const Located<std::string>& name, int dim) {
    const auto known = raw.group_names(dim);
    const auto match = nearest_match(name.value, known);
    std::string message = "the mesh has no physical group '" + name.value + "'";
    const auto dims = dims_of_group(name.value);
    if (!dims.empty())
      message = "the physical group '" + name.value + "' is made of " + group_kind(dims[0]) + ", but here must be " +
                group_kind(dim);
    else if (dim >= 0)
      message += std::string(" of ") + group_kind(dim);
    message += ".";
    if (!match.empty() && match != name.value) message += " Did you mean '" + match + "'?";
    const std::string kind = dim < 0 ? "Groups" : std::string("Groups of ") + group_kind(dim);
    fail(name.place, message + (known.empty() ? " It has no such groups: name some in the geometry."
                                              : " " + kind + " in the mesh: " + join_names(known) + "."));
  }
  bool require_group(const Located<std::string>& name, int dim) {
    const bool there = dim < 0 ? !dims_of_group(name.value).empty() : has_group(name.value, dim);
    if (!there) fail_missing(name, dim);
    return there;
  }

  /// Nodes of all elements of the group, sorted, each once.
  std::vector<std::int64_t> nodes_of_group(const std::string& name) const {
    std::vector<std::int64_t> nodes;
    for (const auto& sub : raw.subs)
      if (raw.groups[sub.group].name == name) nodes.insert(nodes.end(), sub.nodes.begin(), sub.nodes.end());
    for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell)
      if (raw.groups[raw.cell_bodies[cell]].name == name)
        nodes.insert(nodes.end(), raw.cell_nodes.begin() + raw.cell_offsets[cell],
                     raw.cell_nodes.begin() + raw.cell_offsets[cell + 1]);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  std::span<const double> position(std::int64_t node) const {
    return std::span(raw.coordinates).subspan(3 * std::size_t(node), std::size_t(raw.dim));
  }
};

void check_space(Fit& fit) {
  if (fit.deck.dim() != fit.raw.dim)
    fit.fail(fit.deck.mesh.file.place, "the mesh is " + std::to_string(fit.raw.dim) + "D, but space: says " +
                                           std::to_string(fit.deck.dim()) + "D. " +
                                           (fit.raw.dim == 3 ? "Set space: solid, or name the cells' groups as "
                                                               "Physical Surface only and mesh in 2D."
                                                             : "Choose plane_strain, plane_stress or axisymmetric, or "
                                                               "give volumes a Physical Volume."));
  if (fit.deck.space != Space::Axisymmetric) return;
  double lowest = 0.0, extent = 0.0;
  for (const auto node : fit.raw.cell_nodes) {
    const double x = fit.raw.coordinates[3 * std::size_t(node)];
    lowest = std::min(lowest, x);
    extent = std::max(extent, std::abs(x));
  }
  // A mesh generator may put nodes of the axis a rounding error to its left.
  if (lowest < -1e-9 * extent)
    fit.fail(fit.deck.mesh.file.place, "space: axisymmetric takes x as the radius, but the mesh reaches x = " +
                                           number_text(lowest) + ". Draw only the half with x >= 0.");
}

void check_bodies(Fit& fit) {
  for (const auto& [body, material] : fit.deck.bodies)
    fit.require_group({body, material.place}, fit.raw.dim);
  for (const auto& name : fit.raw.group_names(fit.raw.dim)) {
    if (fit.deck.bodies.contains(name)) continue;
    const auto& place = fit.deck.bodies.begin()->second.place;
    fit.fail(place, "the body '" + name + "' of the mesh has no material. Add '" + name + ": <material>' to bodies.");
  }
}

bool has_any(const VectorDeck& vector) {
  return std::any_of(vector.begin(), vector.end(), [](const auto& component) { return component.has_value(); });
}

/// Checks the groups that conditions act on and figures are of; returns the surfaces that are loaded.
std::vector<Located<std::string>> check_boundary(Fit& fit) {
  std::vector<Located<std::string>> loaded;
  for (const auto& entry : fit.deck.boundary) {
    const bool load = has_any(entry.traction) || entry.pressure;
    if (fit.require_group(entry.on, load ? fit.raw.dim - 1 : -1) && load) loaded.push_back(entry.on);
  }
  for (const auto& [name, figure] : fit.deck.figures)
    fit.require_group(figure.of, -1);
  return loaded;
}

using FacetKey = std::vector<std::int64_t>;

std::set<FacetKey> facets_of_group(const RawMesh& raw, const std::string& name) {
  std::set<FacetKey> facets;
  for (const auto& sub : raw.subs) {
    const auto& group = raw.groups[sub.group];
    if (group.dim != raw.dim - 1 || group.name != name) continue;
    FacetKey key(sub.nodes.begin(), sub.nodes.begin() + num_vertices(sub.type));
    std::sort(key.begin(), key.end());
    facets.insert(std::move(key));
  }
  return facets;
}

/// Only facets of order 1 can be smoothed, in 3D only quadrangles.
void check_smoothing(Fit& fit, const ContactDeck& contact, const Located<std::string>& master) {
  if (!std::holds_alternative<CubicMasterDeck>(contact.smoothing)) return;
  if (fit.raw.order != 1)
    fit.fail(master.place, "the master '" + master.value +
                               "' is smoothed, but its facets are of order 2 and curved "
                               "already. Take the smoothing out, or set mesh.order: 1.");
  const bool has_triangles = std::any_of(fit.raw.subs.begin(), fit.raw.subs.end(), [&](const auto& sub) {
    return fit.raw.groups[sub.group].name == master.value && num_vertices(sub.type) == 3;
  });
  if (has_triangles)
    fit.fail(master.place, "the master '" + master.value +
                               "' is smoothed, but has triangles. Mesh it with quadrangles "
                               "(Recombine Surface), or take the smoothing out.");
}

/// Checks the surfaces of all pairs; returns those that exist.
std::vector<Located<std::string>> check_contact(Fit& fit) {
  std::vector<Located<std::string>> surfaces;
  for (const auto& contact : fit.deck.contact) {
    if (contact.sides == ContactSides::All) continue;
    const bool slave_exists = fit.require_group(contact.slave, fit.raw.dim - 1);
    if (slave_exists) surfaces.push_back(contact.slave);
    if (meets_itself(contact)) continue;
    const auto* master = std::get_if<Located<std::string>>(&contact.master.value);
    if (!master || !fit.require_group(*master, fit.raw.dim - 1)) continue;
    surfaces.push_back(*master);
    check_smoothing(fit, contact, *master);
    if (!slave_exists) continue;
    const auto slave_facets = facets_of_group(fit.raw, contact.slave);
    std::size_t common = 0;
    for (const auto& facet : facets_of_group(fit.raw, *master))
      common += slave_facets.count(facet);
    if (common > 0)
      fit.fail(contact.slave.place, "slave '" + contact.slave.value + "' and master '" + master->value + "' have " +
                                        std::to_string(common) +
                                        " facets in common. Each facet belongs to one side, and " +
                                        "each body needs nodes of its own: draw the bodies with separate points.");
  }
  return surfaces;
}

/// Each surface that is loaded or in contact must be the skin of a body.
void check_surfaces(Fit& fit, const std::vector<Located<std::string>>& surfaces) {
  std::set<std::string> seen;
  for (const auto& surface : surfaces) {
    if (!seen.insert(surface.value).second) continue;
    try {
      check_boundary_groups(fit.raw, {surface.value});
    } catch (const UserError& error) {
      for (const auto& message : error.messages())
        fit.fail(surface.place, message);
    }
  }
}

/// What one entry of `boundary` says about a displacement component at the nodes of its group.
struct Prescription {
  const BoundaryDeck* entry;
  const Expression* displacement; // null: a resultant ties the nodes together
};

bool agree(const Fit& fit, const Prescription& a, const Prescription& b, std::int64_t node) {
  if (!a.displacement || !b.displacement) return false;
  const auto place = fit.position(node);
  return std::all_of(fit.deck.steps.begin(), fit.deck.steps.end(), [&](const StepDeck& step) {
    const double first = (*a.displacement)(step.to, place), second = (*b.displacement)(step.to, place);
    return std::abs(first - second) <= 1e-9 * std::max(std::abs(first), std::abs(second));
  });
}

std::string node_text(const Fit& fit, std::int64_t node) {
  std::string text = "(";
  for (const double x : fit.position(node))
    text.append(text.size() > 1 ? ", " : "").append(number_text(x));
  return text.append(")");
}

/// Two conditions that meet at a node must want the same there, or the result would depend on who comes last.
void check_shared_nodes(Fit& fit, std::size_t component) {
  std::vector<Prescription> prescriptions;
  for (const auto& entry : fit.deck.boundary) {
    if (fit.dims_of_group(entry.on).empty()) continue;
    if (entry.displacement[component]) prescriptions.push_back({&entry, &*entry.displacement[component]});
    if (entry.resultant[component]) prescriptions.push_back({&entry, nullptr});
  }
  if (prescriptions.size() < 2) return;
  std::vector<std::int32_t> taken(fit.raw.coordinates.size() / 3, -1);
  std::set<std::pair<std::int32_t, std::int32_t>> reported;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(prescriptions.size()); ++i)
    for (const auto node : fit.nodes_of_group(prescriptions[i].entry->on)) {
      const auto other = std::exchange(taken[node], i);
      if (other < 0 || agree(fit, prescriptions[i], prescriptions[other], node)) continue;
      if (!reported.insert({other, i}).second) continue;
      const auto& here = *prescriptions[i].entry;
      const auto& there = *prescriptions[other].entry;
      fit.fail(here.on.place, "'" + here.on.value + "' and '" + there.on.value + "' (line " +
                                  std::to_string(there.on.place.line) + ") share the node at " + node_text(fit, node) +
                                  " and want different things of its displacement in " + axes[component] +
                                  ". Give both the same value there, or drop the component from one of them.");
    }
}

/// Prescribed displacements must be numbers wherever they act.
void check_finite(Fit& fit) {
  for (const auto& entry : fit.deck.boundary) {
    if (!has_any(entry.displacement)) continue;
    const auto nodes = fit.nodes_of_group(entry.on);
    for (std::size_t component = 0; component < 3; ++component) {
      const auto& value = entry.displacement[component];
      if (!value || value->is_constant()) continue;
      for (const auto& step : fit.deck.steps) {
        const auto bad = std::find_if(nodes.begin(), nodes.end(), [&](std::int64_t node) {
          return !std::isfinite((*value)(step.to, fit.position(node)));
        });
        if (bad == nodes.end()) continue;
        fit.fail(entry.on.place, "the displacement in " + std::string(axes[component]) + " of '" + entry.on.value +
                                     "', \"" + value->text() + "\", is not a finite number at t = " +
                                     number_text(step.to) + " at " + node_text(fit, *bad) + ". Mend the expression.");
        break;
      }
    }
  }
}

} // namespace

MeshSource mesh_source(const Deck& deck, const FreeMeshing& meshing) {
  MeshSource source{(std::filesystem::path(deck.folder) / deck.mesh.file.value).string(), deck.mesh.parameters,
                    deck.mesh.order};
  if (deck.adapt) source.free = meshing;
  return source;
}

ContactHints contact_hints(const Deck& deck) {
  ContactHints hints;
  for (const auto& contact : deck.contact)
    if (const auto* master = std::get_if<Located<std::string>>(&contact.master.value); master && !meets_itself(contact))
      hints.push_back({contact.slave.value, master->value});
  return hints;
}

void validate_against_mesh(const Deck& deck, const RawMesh& raw) {
  Fit fit{deck, raw};
  check_space(fit);
  // In the wrong space every group has the wrong dimension: one message is enough.
  if (deck.dim() == raw.dim) {
    check_bodies(fit);
    auto surfaces = check_boundary(fit);
    const auto contact = check_contact(fit);
    surfaces.insert(surfaces.end(), contact.begin(), contact.end());
    check_surfaces(fit, surfaces);
    for (std::size_t component = 0; component < std::size_t(raw.dim); ++component)
      check_shared_nodes(fit, component);
    check_finite(fit);
  }
  if (!fit.messages.empty()) throw UserError(std::move(fit.messages));
}

RawMesh read_checked_mesh(MPI_Comm comm, const Deck& deck, const FreeMeshing& meshing) {
  RawMesh raw;
  on_root(comm, [&] {
    raw = read_mesh(mesh_source(deck, meshing));
    validate_against_mesh(deck, raw);
  });
  return raw;
}

} // namespace amontons
