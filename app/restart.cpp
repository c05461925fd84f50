#include "restart.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "deck/rule.hpp"
#include "form/point_rows.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Two ranks' places of one point differ by rounding; neighbouring points by a good part of a facet.
constexpr double same_place = 1e-6;

constexpr int place_size = 3, row_size = place_size + PointHistory::row_size;

std::string multiplier_name(const PairReport& contact) { return "multiplier:" + contact.pair().name; }
std::string history_name(const PairReport& contact) { return "friction:" + contact.pair().name; }

bool has_multipliers(const PairReport& contact) { return !std::holds_alternative<Penalty>(contact.pair().enforcement); }

/// Normal multipliers, then the components of the tangential ones, at all local nodes of the mesh.
NodalArray nodal_multipliers(const Scene& scene, const PairReport& contact, const ContactHistory& history) {
  std::vector<const std::vector<double>*> fields = {&history.multipliers};
  for (const auto& component : history.tangential_multipliers)
    fields.push_back(&component);
  NodalArray array{static_cast<int>(fields.size()),
                   std::vector<double>(std::size_t(scene.mesh.num_local()) * fields.size(), 0.0)};
  for (std::size_t i = 0; i < contact.nodes().nodes.size(); ++i)
    for (std::size_t k = 0; k < fields.size(); ++k)
      array.values[std::size_t(contact.nodes().nodes[i]) * fields.size() + k] = (*fields[k])[i];
  return array;
}

/// One row a point: its reference place, by which it is found again, and its history.
FacetArray point_rows(const PairReport& contact, const ContactHistory& history) {
  const auto& points = contact.points();
  FacetArray array{.surface = contact.pair().slave,
                   .components = row_size,
                   .rows = std::vector<std::int32_t>(points.slave().size(), 0),
                   .values = {}};
  for (std::size_t i = 0; i < points.points().size(); ++i) { // facet by facet
    const auto& point = points.points()[i];
    ++array.rows[point.facet];
    array.values.insert(array.values.end(), point.place.begin(), point.place.end());
    history.points[i].append_to(array.values);
  }
  return array;
}

double distance(std::span<const double> row, const ContactPoint& point) {
  return std::hypot(row[0] - point.place[0], row[1] - point.place[1], row[2] - point.place[2]);
}

/// The histories of a pair's points out of the rows of their facets, by place: a facet whose nodes have got another
/// order has its points in another order.
std::vector<PointHistory> histories_from(const FacetArray& array, const PairReport& contact) {
  std::vector<std::size_t> first(array.rows.size() + 1, 0);
  for (std::size_t f = 0; f < array.rows.size(); ++f)
    first[f + 1] = first[f] + array.rows[f];
  std::vector<PointHistory> histories;
  for (const auto& point : contact.points().points()) {
    std::span<const double> nearest;
    for (std::size_t row = first[point.facet]; row < first[point.facet + 1]; ++row) {
      const auto candidate = std::span(array.values).subspan(row * row_size, row_size);
      if (nearest.empty() || distance(candidate, point) < distance(nearest, point)) nearest = candidate;
    }
    if (nearest.empty() || distance(nearest, point) > same_place * point.size)
      throw UserError("--restart: the pair '" + contact.pair().name +
                      "' has other quadrature points than in the run that wrote the checkpoint. Restart with the same "
                      "integration.");
    histories.push_back(PointHistory::from_row(nearest.subspan(place_size)));
  }
  return histories;
}

/// Unknown multipliers go into the vector of unknowns, too.
void put_unknown_multipliers(const DofLayout& layout, const PairReport& contact, const ContactHistory& history,
                             Vec unknowns) {
  const auto* unknown = std::get_if<Semismooth>(&contact.pair().enforcement);
  if (!unknown) return;
  VecArray values(unknowns);
  const auto put = [&](int field, const std::vector<double>& multipliers) {
    for (std::size_t i = 0; i < multipliers.size(); ++i) {
      const PetscInt owned = layout.extra_equation(field, contact.nodes().nodes[i]) - layout.first_equation();
      if (owned >= 0 && owned < layout.num_owned()) values[owned] = multipliers[i] / contact.multiplier_scale();
    }
  };
  put(unknown->field, history.multipliers);
  for (std::size_t c = 0; c < history.tangential_multipliers.size(); ++c)
    put(contact.pair().friction->field + static_cast<int>(c), history.tangential_multipliers[c]);
}

void restore_pair(const Scene& scene, PairReport& contact, const Checkpoint& checkpoint, Vec unknowns) {
  auto history = contact.accepted(); // for its sizes
  history.time = checkpoint.time;
  if (has_multipliers(contact)) {
    const auto& stored = checkpoint.nodal.at(multiplier_name(contact));
    for (std::size_t i = 0; i < contact.nodes().nodes.size(); ++i) {
      const auto row = std::span(stored.values)
                           .subspan(std::size_t(contact.nodes().nodes[i]) * stored.components, stored.components);
      history.multipliers[i] = row[0];
      for (std::size_t c = 0; c < history.tangential_multipliers.size(); ++c)
        history.tangential_multipliers[c][i] = row[c + 1];
    }
  }
  if (contact.tangential())
    together(scene.mesh.comm,
             [&] { history.points = histories_from(checkpoint.facets.at(history_name(contact)), contact); });
  contact.restore(history);
  put_unknown_multipliers(*scene.layout, contact, history, unknowns);
}

std::string points_name(const std::string& body) { return "points:" + body; }

void save_points(const Scene& scene, Checkpoint& checkpoint) {
  const auto& states = scene.bulk->point_states();
  for (std::size_t body = 0; body < scene.mesh.bodies.size(); ++body) {
    if (state_size(scene.mesh, states, body) == 0) continue;
    auto rows = point_rows(scene.mesh, scene.deck.space, states, body);
    checkpoint.cells[points_name(scene.mesh.bodies[body])] = {.body = scene.mesh.bodies[body],
                                                              .components = rows.components,
                                                              .rows = std::move(rows.rows),
                                                              .values = std::move(rows.values)};
  }
}

void restore_points(Scene& scene, const Checkpoint& checkpoint) {
  PointStates states = scene.bulk->point_states(); // for its sizes
  states.time = checkpoint.time;
  for (std::size_t body = 0; body < scene.mesh.bodies.size(); ++body) {
    if (state_size(scene.mesh, states, body) == 0) continue;
    const auto& stored = checkpoint.cells.at(points_name(scene.mesh.bodies[body]));
    together(scene.mesh.comm, [&] {
      put_point_rows(scene.mesh, scene.deck.space, body, {stored.components, stored.rows, stored.values}, states);
    });
  }
  scene.bulk->restore_points(std::move(states));
}

std::string enforcement_text(const ContactPair& pair) {
  const int degree = std::visit([](const auto& rule) { return rule.degree; }, pair.integration);
  return formatted("enforcement %d, friction %d, integration %d, degree %d", static_cast<int>(pair.enforcement.index()),
                   pair.friction ? static_cast<int>(pair.friction->law.index()) : -1,
                   static_cast<int>(pair.integration.index()), degree);
}

} // namespace

std::string run_identity(const Scene& scene) {
  std::string identity;
  for (const auto& [body, material] : scene.deck.bodies)
    identity += body + "=" + material.value + ";";
  for (const auto& body : scene.mesh.bodies) {
    const auto& material = scene.deck.materials.at(scene.deck.bodies.at(body).value).value;
    identity += body + ":" + bulk_material_rule().show(material.law) + ";";
  }
  identity += scene.deck.kinematics == Kinematics::Finite ? "finite;" : "small;";
  for (const auto* contact : scene.contacts)
    identity += contact->pair().name + ":" + contact->pair().slave + ":" + enforcement_text(contact->pair()) + ";";
  return identity;
}

Checkpoint make_checkpoint(const Scene& scene, const Ledger& ledger, Vec accepted) {
  const auto state = scene.problem->state_at(accepted);
  Checkpoint checkpoint;
  checkpoint.time = state.time;
  checkpoint.nodal["displacement"] = {scene.mesh.dim, {state.displacement.begin(), state.displacement.end()}};
  for (const auto* contact : scene.contacts) {
    const auto history = contact->accepted();
    if (has_multipliers(*contact))
      checkpoint.nodal[multiplier_name(*contact)] = nodal_multipliers(scene, *contact, history);
    if (contact->tangential()) checkpoint.facets[history_name(*contact)] = point_rows(*contact, history);
  }
  save_points(scene, checkpoint);
  checkpoint.global["largest_force"] = {scene.problem->largest_force()};
  ledger.save(checkpoint);
  return checkpoint;
}

void restore_state(Scene& scene, Ledger& ledger, const Checkpoint& checkpoint, Vec unknowns) {
  scene.layout->put_displacement(checkpoint.nodal.at("displacement").values, unknowns);
  for (auto* contact : scene.contacts)
    restore_pair(scene, *contact, checkpoint, unknowns);
  restore_points(scene, checkpoint);
  scene.problem->resume(checkpoint.time, checkpoint.global.at("largest_force").at(0));
  const auto state = scene.problem->state_at(unknowns);
  for (auto* contact : scene.contacts)
    contact->remember(state);
  ledger.restore(checkpoint, unknowns);
}

} // namespace amontons
