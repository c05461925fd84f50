#include "scene.hpp"

#include "base/error.hpp"
#include "base/timer.hpp"
#include "form/bulk.hpp"
#include "form/finite_bulk.hpp"
#include "form/follower_pressure.hpp"
#include "form/support.hpp"
#include "geometry/box_tree.hpp"
#include "validate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace amontons {

namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

const BulkMaterial& material_of(const Deck& deck, const std::string& body) {
  return deck.materials.at(deck.bodies.at(body).value).value.law;
}

/// The form of the deck's kinematics, with a law for each body. Collective.
std::unique_ptr<SolidForm> make_solid(const Deck& deck, const DofLayout& layout, std::vector<BodyLoad> body_loads) {
  const auto& bodies = layout.mesh().bodies;
  if (deck.kinematics == Kinematics::Finite) {
    std::vector<FiniteLaw> laws;
    for (const auto& body : bodies)
      laws.push_back(finite_law(material_of(deck, body)));
    return std::make_unique<FiniteBulkForm>(layout, deck.space, std::move(laws));
  }
  std::vector<SmallLaw> laws;
  for (const auto& body : bodies)
    laws.push_back(small_law(material_of(deck, body), body));
  return std::make_unique<BulkForm>(layout, deck.space, std::move(laws), std::move(body_loads));
}

double sum_over_ranks(MPI_Comm comm, double mine) {
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, comm);
  return mine;
}

/// Diagonal of the box around a surface, over all ranks. Collective.
double surface_diagonal(const Mesh& mesh, const std::string& name) {
  Box box;
  for (const auto node : mesh.node_groups.at(name))
    box.include(mesh.position(node));
  MPI_Allreduce(MPI_IN_PLACE, box.low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, box.high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return box.diagonal();
}

/// Which bodies a pair is about. Collective.
std::vector<int> bodies_of(const Mesh& mesh, const ContactPair& pair) {
  std::vector<int> flags(mesh.bodies.size(), 0);
  const auto add = [&](const std::string& surface) {
    for (const auto body : mesh.surfaces.at(surface).bodies)
      flags[body] = 1;
  };
  add(pair.slave);
  if (const auto* master = std::get_if<std::string>(&pair.master)) add(*master);
  MPI_Allreduce(MPI_IN_PLACE, flags.data(), static_cast<int>(flags.size()), MPI_INT, MPI_MAX, mesh.comm);
  return flags;
}

/// How near the surfaces of a pair are at the start, in facet sizes. Collective.
double nearest_gap(const Mesh& mesh, const ContactPoints& points) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& point : points.points())
    if (point.master != ContactPoint::none) nearest = std::min(nearest, point.gap0 / point.size);
  MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE, MPI_MIN, mesh.comm);
  return nearest;
}

/// Tells the pairs that hold a floating body. One that touches something at the start is held by that: what is open is
/// not guessed to be closed, which would throw the first iterate as far as it is open. Collective.
void find_holders(const Mesh& mesh, const std::vector<std::uint8_t>& floating,
                  const std::vector<PairReport*>& contacts) {
  std::vector<std::vector<int>> bodies;
  std::vector<double> gaps, nearest(mesh.bodies.size(), std::numeric_limits<double>::infinity());
  for (const auto* contact : contacts) {
    bodies.push_back(bodies_of(mesh, contact->pair()));
    gaps.push_back(nearest_gap(mesh, contact->points()));
    for (std::size_t b = 0; b < nearest.size(); ++b)
      if (bodies.back()[b]) nearest[b] = std::min(nearest[b], gaps.back());
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    bool holds = false;
    for (std::size_t b = 0; b < nearest.size(); ++b)
      holds = holds || (bodies[i][b] && floating[b] && (gaps[i] <= guess_reach || nearest[b] > guess_reach));
    contacts[i]->hold_floating_body(holds);
  }
}

std::array<double, 3> padded(const std::vector<double>& values) {
  std::array<double, 3> array{};
  std::copy_n(values.begin(), std::min<std::size_t>(3, values.size()), array.begin());
  return array;
}

std::array<double, 3> unit(std::array<double, 3> vector) {
  const double length = std::hypot(vector[0], vector[1], vector[2]);
  for (double& component : vector)
    component /= length;
  return vector;
}

std::variant<std::string, RigidMaster> make_master(const MasterDeck& master) {
  using Result = std::variant<std::string, RigidMaster>;
  return std::visit(
      Overloaded{[](const Located<std::string>& name) -> Result { return name.value; },
                 [](const PlaneDeck& plane) -> Result {
                   return RigidMaster{RigidPlane{padded(plane.point), unit(padded(plane.normal))}, plane.displacement};
                 },
                 [](const SphereDeck& sphere) -> Result {
                   return RigidMaster{RigidSphere{padded(sphere.centre), sphere.radius}, sphere.displacement};
                 },
                 [](const CylinderDeck& cylinder) -> Result {
                   if (cylinder.axis.empty()) // 2D: the cylinder's section is a circle
                     return RigidMaster{RigidSphere{padded(cylinder.centre), cylinder.radius}, cylinder.displacement};
                   return RigidMaster{
                       RigidCylinder{padded(cylinder.centre), unit(padded(cylinder.axis)), cylinder.radius},
                       cylinder.displacement};
                 },
                 [](const CornerDeck& corner) -> Result {
                   return RigidMaster{rounded_corner(padded(corner.point),
                                                     {unit(padded(corner.normals[0])), unit(padded(corner.normals[1]))},
                                                     corner.radius),
                                      corner.displacement};
                 },
                 [](const RoundedBoxDeck& box) -> Result {
                   return RigidMaster{RigidRoundedBox{.part = box.part,
                                                      .point = padded(box.point),
                                                      .normal = unit(padded(box.normal)),
                                                      .side = unit(padded(box.side)),
                                                      .half_width = {box.half_widths[0], box.half_widths[1]},
                                                      .corner_radius = box.corner_radius,
                                                      .edge_radius = box.edge_radius},
                                      box.displacement};
                 }},
      master);
}

/// The contact pairs, with an extra field of unknowns for each that wants one.
std::vector<ContactPair> make_pairs(const Deck& deck, const Mesh& mesh, const std::vector<double>& stiffness,
                                    std::vector<NodeField>& fields) {
  std::vector<ContactPair> pairs;
  for (const auto& declared : deck.contact) {
    ContactPair pair{.name = declared.name.value,
                     .slave = declared.slave.value,
                     .master = make_master(declared.master.value),
                     .enforcement = {},
                     .projection = {},
                     .kinematics = deck.kinematics,
                     .space = deck.space,
                     .stiffness = {}};
    std::visit(Overloaded{[&](const PenaltyDeck& penalty) {
                            pair.enforcement = Penalty{};
                            pair.alpha = penalty.alpha;
                          },
                          [&](const UzawaDeck& uzawa) {
                            pair.enforcement = Uzawa{};
                            pair.alpha = uzawa.alpha;
                          },
                          [&](const ViDeck&) { pair.enforcement = BoundConstraint{}; },
                          [&](const SemismoothDeck& semismooth) {
                            pair.alpha = semismooth.alpha;
                            if (semismooth.basis == MultiplierBasis::Dual) {
                              pair.enforcement = CondensedSemismooth{};
                              return;
                            }
                            pair.enforcement = Semismooth{static_cast<int>(fields.size())};
                            fields.push_back(multiplier_nodes(mesh, pair.name, pair.slave));
                            if (declared.friction) fields.insert(fields.end(), mesh.dim, NodeField(fields.back()));
                          }},
               declared.enforce);
    if (std::holds_alternative<SlaveNormalDeck>(declared.projection)) pair.projection = SlaveNormal{};
    if (const auto* cubic = std::get_if<CubicMasterDeck>(&declared.smoothing))
      pair.smoothing = CubicMaster{cubic->crease_angle};
    if (declared.friction) {
      const auto* unknown = std::get_if<Semismooth>(&pair.enforcement);
      pair.friction = Friction{
          .law = *declared.friction, .factor = declared.friction_factor, .field = unknown ? unknown->field + 1 : -1};
    }
    std::visit(Overloaded{[&](const FacetIntegrationDeck& facet) { pair.integration = FacetIntegration{facet.order}; },
                          [&](const SegmentIntegrationDeck& segment) {
                            pair.integration = SegmentIntegration{segment.order};
                          }},
               declared.integration);
    pair.search_distance = declared.search_distance.value_or(0.1 * surface_diagonal(mesh, pair.slave));
    if (const auto* master = std::get_if<std::string>(&pair.master)) {
      if (!declared.search_distance)
        pair.search_distance = std::min(pair.search_distance, 0.1 * surface_diagonal(mesh, *master));
    }
    pair.stiffness = stiffness;
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

/// What the deck's `boundary` and `body_force` ask for.
struct Conditions {
  std::vector<PrescribedDisplacement> prescribed;
  std::vector<TiedGroup> tied;
  std::vector<SurfaceLoad> surface;
  std::vector<FollowerPressure> follower; // instead of pressures in `surface`, in finite kinematics
  std::vector<BodyLoad> body;
  std::vector<ResultantLoad> resultants;
};

Conditions make_conditions(const Deck& deck) {
  Conditions conditions;
  for (const auto& condition : deck.boundary) {
    for (int c = 0; c < 3; ++c) {
      if (condition.displacement[c])
        conditions.prescribed.push_back({condition.on.value, c, *condition.displacement[c]});
      if (condition.resultant[c]) {
        conditions.resultants.push_back({conditions.tied.size(), *condition.resultant[c]});
        conditions.tied.push_back({condition.on.value, c});
      }
    }
    const bool traction =
        std::any_of(condition.traction.begin(), condition.traction.end(), [](const auto& c) { return c.has_value(); });
    const bool follows = condition.pressure && deck.kinematics == Kinematics::Finite;
    if (follows) conditions.follower.push_back({condition.on.value, *condition.pressure});
    if (traction || (condition.pressure && !follows))
      conditions.surface.push_back(
          {condition.on.value, condition.traction, follows ? std::optional<Expression>() : condition.pressure});
  }
  for (const auto& [body, force] : deck.body_force)
    conditions.body.push_back({body, force.value});
  return conditions;
}

/// A friction factor below zero is found before anything is computed: at the slave's nodes, at the start and at the end
/// of each step. (What lies between is checked as the run gets there.) Collective.
void check_friction_factors(const Deck& deck, const Mesh& mesh) {
  together(mesh.comm, [&] {
    for (const auto& pair : deck.contact) {
      if (!pair.friction_factor) continue;
      std::vector<double> times = {0.0};
      for (const auto& step : deck.steps)
        times.push_back(step.to);
      for (const double time : times)
        for (const auto node : mesh.node_groups.at(pair.slave.value))
          if (!((*pair.friction_factor)(time, mesh.position(node)) >= 0.0))
            throw UserError(pair.name.place.text() + ": the friction_factor of the pair '" + pair.name.value +
                            "' is negative or not a number at t = " + std::to_string(time) +
                            " on its slave surface. Make it an expression that is never below zero.");
    }
  });
}

/// Small kinematics searches once: a pair of which no point finds its master has no effect, whatever moves. Collective.
void check_masters(const Deck& deck, MPI_Comm comm, const std::vector<PairReport*>& contacts) {
  if (deck.kinematics != Kinematics::Small) return;
  std::vector<int> found(contacts.size(), 0);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    for (const auto& point : contacts[i]->points().points())
      if (point.master != ContactPoint::none) found[i] = 1;
  MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_INT, MPI_MAX, comm);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (!found[i])
      throw UserError(deck.contact[i].name.place.text() + ": no point of the slave surface '" +
                      contacts[i]->pair().slave + "' of the pair '" + contacts[i]->pair().name +
                      "' faces its master within the search_distance of " +
                      std::to_string(contacts[i]->pair().search_distance) +
                      ": they can never touch. Check that the two surfaces face each other, or set a larger "
                      "search_distance.");
}

} // namespace

std::vector<double> Scene::stiffness() const {
  std::vector<double> stiffness;
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b)
    stiffness.push_back(bulk->stiffness(static_cast<std::int32_t>(b)));
  return stiffness;
}

double Scene::bulk_energy(Vec unknowns) const {
  return sum_over_ranks(mesh.comm, bulk->stored_energy(problem->state_at(unknowns)));
}

double Scene::bulk_dissipation(Vec unknowns) const {
  return sum_over_ranks(mesh.comm, bulk->dissipated_energy(problem->state_at(unknowns)));
}

double Scene::internal_work(Vec unknowns) const {
  return sum_over_ranks(mesh.comm, bulk->internal_work(problem->state_at(unknowns)));
}

std::unique_ptr<Scene> build_scene(MPI_Comm comm, Deck checked, const FreeMeshing& meshing) {
  auto scene = std::make_unique<Scene>();
  {
    const Phase phase("mesh");
    scene->deck = std::move(checked);
    const auto raw = read_checked_mesh(comm, scene->deck, meshing);
    scene->mesh = distribute_mesh(comm, raw, contact_hints(scene->deck), scene->deck.mesh.refine);
  }
  const auto& deck = scene->deck;
  const auto& mesh = scene->mesh;
  if (std::any_of(deck.contact.begin(), deck.contact.end(),
                  [](const auto& contact) { return contact.sides == ContactSides::All; }))
    name_exterior(scene->mesh);
  const Phase phase("set up");
  check_friction_factors(deck, mesh);
  auto conditions = make_conditions(deck);
  const auto floating = find_floating_bodies(mesh, conditions.prescribed, deck.space == Space::Axisymmetric);
  std::vector<double> stiffness;
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    stiffness.push_back(initial_stiffness(material_of(deck, mesh.bodies[b])));
    if (floating[b]) scene->floating.push_back(mesh.bodies[b]);
  }
  std::vector<NodeField> fields;
  auto pairs = make_pairs(deck, mesh, stiffness, fields);
  scene->layout = std::make_unique<DofLayout>(mesh, conditions.tied, fields);
  const auto& layout = *scene->layout;

  std::vector<std::unique_ptr<Form>> forms;
  auto bulk = make_solid(deck, layout, conditions.body);
  scene->bulk = bulk.get();
  forms.push_back(std::move(bulk));
  if (!conditions.surface.empty() || !conditions.body.empty() || !conditions.resultants.empty()) {
    auto loads = std::make_unique<LoadForm>(layout, deck.space, std::move(conditions.surface),
                                            std::move(conditions.body), std::move(conditions.resultants));
    scene->loads = loads.get();
    forms.push_back(std::move(loads));
  }
  if (!conditions.follower.empty()) {
    auto pressure = std::make_unique<FollowerPressureForm>(layout, deck.space, std::move(conditions.follower));
    scene->follower = pressure.get();
    forms.push_back(std::move(pressure));
  }
  if (!scene->floating.empty()) forms.push_back(std::make_unique<SupportForm>(layout, floating, stiffness));
  if (deck.stabilization) {
    const double ratio = std::get<ViscousDeck>(*deck.stabilization).ratio;
    auto viscous = std::make_unique<ViscousForm>(layout, deck.space, stiffness, ratio, deck.steps.back().to);
    scene->stabilization = viscous.get();
    forms.push_back(std::move(viscous));
  }
  std::vector<ContactForm*> uzawa;
  std::vector<MortarForm*> bounded, condensed;
  for (auto& pair : pairs) {
    const Phase search("search");
    const bool is_bound = std::holds_alternative<BoundConstraint>(pair.enforcement);
    if (is_bound || std::holds_alternative<CondensedSemismooth>(pair.enforcement)) {
      auto form = std::make_unique<MortarForm>(layout, std::move(pair));
      scene->contacts.push_back(form.get());
      (is_bound ? bounded : condensed).push_back(form.get());
      forms.push_back(std::move(form));
      continue;
    }
    auto form = std::make_unique<ContactForm>(layout, std::move(pair));
    scene->contacts.push_back(form.get());
    if (form->has_multipliers()) scene->with_multipliers.push_back(form.get());
    if (std::holds_alternative<Uzawa>(form->pair().enforcement)) uzawa.push_back(form.get());
    forms.push_back(std::move(form));
  }
  check_masters(deck, mesh.comm, scene->contacts);
  if (!scene->floating.empty()) find_holders(mesh, floating, scene->contacts);
  if (!uzawa.empty()) scene->multipliers = std::make_unique<UzawaMultipliers>(mesh, uzawa);
  scene->problem = std::make_unique<Problem>(layout, std::move(forms), std::move(conditions.prescribed));
  if (!bounded.empty()) scene->bounds = std::make_unique<MortarTransform>(*scene->problem, std::move(bounded));
  if (!condensed.empty()) scene->conditions = std::make_unique<CondensedContact>(*scene->problem, condensed);
  return scene;
}

namespace {

MovedShape moved_shape(const RigidMaster& rigid, const std::array<double, 3>& shift, double accepted_time) {
  MovedShape shape{rigid.shape, shift, {}};
  for (std::size_t c = 0; c < 3; ++c)
    if (rigid.displacement[c]) shape.increment[c] = shift[c] - (*rigid.displacement[c])(accepted_time);
  return shape;
}

} // namespace

std::vector<ContactPairNames> pair_names(const Scene& scene) {
  std::vector<ContactPairNames> names;
  for (const auto* contact : scene.contacts) {
    ContactPairNames pair{.name = contact->pair().name, .slave = contact->pair().slave, .master = {}};
    if (const auto* rigid = std::get_if<RigidMaster>(&contact->pair().master))
      pair.master = moved_shape(*rigid, contact->rigid_shift(), scene.problem->accepted_time());
    else
      pair.master = std::get<std::string>(contact->pair().master);
    if (const auto& friction = contact->pair().friction) pair.friction = friction->law;
    names.push_back(std::move(pair));
  }
  return names;
}

} // namespace amontons
