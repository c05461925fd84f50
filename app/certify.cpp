#include "certify.hpp"

#include "base/log.hpp"
#include "geometry/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

/// Strain below which forces and energies are rounding.
constexpr double rounding_strain = 1e-10;
/// Part of the largest force in any accepted state below which forces are what unloading has left.
constexpr double unloaded_ratio = 1e-6;

/// Size of the mesh's box. Collective.
double scene_size(const Mesh& mesh) {
  Box box;
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    box.include(mesh.position(node));
  MPI_Allreduce(MPI_IN_PLACE, box.low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, box.high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return box.diagonal();
}

double softest(const Scene& scene) {
  double stiffness = 1e300;
  for (std::size_t b = 0; b < scene.mesh.bodies.size(); ++b)
    stiffness = std::min(stiffness, scene.bulk->stiffness(static_cast<std::int32_t>(b)));
  return stiffness;
}

template <class Holds>
bool any_pair(const Deck& deck, Holds&& holds) {
  return std::any_of(deck.contact.begin(), deck.contact.end(), holds);
}

/// What the deck prescribes now, at this rank's nodes.
std::vector<SupportedComponent> supports_of(const Scene& scene) {
  std::vector<SupportedComponent> supports;
  const auto& mesh = scene.mesh;
  for (const auto& condition : scene.problem->prescribed())
    for (const auto node : mesh.node_groups.at(condition.group))
      if (node < mesh.num_owned)
        supports.push_back({node, condition.component, condition.value(scene.problem->time(), mesh.position(node))});
  return supports;
}

/// What to change in the deck so that the item may pass; empty where there is no rule. Each is tried by
/// tests/hard/advice.py on a scene that fails without it.
std::string advice(const Certificate::Item& item, const Deck& deck) {
  const bool is_overlap = item.name == "penetration" || item.name == "complementarity" || item.name == "missed_contact";
  if (is_overlap && any_pair(deck, [](const auto& pair) { return std::holds_alternative<PenaltyDeck>(pair.enforce); }))
    return formatted(
        ". A penalty lets bodies overlap by pressure h / (alpha E), on any mesh: make alpha larger, at least %.0f "
        "times "
        "and more where prescribed displacements press the bodies, or take `enforce: {semismooth: {}}` or `{uzawa: "
        "{}}`, which leave no overlap. (A nearly incompressible body that is held all around is much stiffer than its "
        "E.)",
        std::ceil(item.value / item.tolerance));
  if (item.name == "complementarity" || item.name == "penetration")
    return ". Facets that are too large for the shapes and edges there do that: make both sides' smaller.";
  if (item.name == "energy" &&
      any_pair(deck, [](const auto& pair) { return std::holds_alternative<SlaveNormalDeck>(pair.projection); }))
    return ". Forces along the slave's normal have no energy over inclined facets: take `projection: {closest_point: "
           "{}}`.";
  if ((item.name == "body_balance" || item.name == "moment_balance") && any_pair(deck, [](const auto& pair) {
        return std::holds_alternative<ViDeck>(pair.enforce) || is_condensed(pair.enforce);
      }))
    return ". Forces of nodes (`vi`, `basis: dual`) across a gap that is not parallel leave a small couple: take "
           "`enforce: {semismooth: {}}`, or smaller facets.";
  return "";
}

} // namespace

Certificate certify_state(Scene& scene, Ledger& ledger, const std::vector<ContactSamples>& samples, Vec accepted,
                          Vec unknowns) {
  const auto pairs = pair_names(scene);
  const auto forces = ledger.nodal_external_forces(unknowns);
  const auto supports = supports_of(scene);
  const auto& deck = scene.deck.certificate;
  const auto before = scene.problem->state_at(accepted).displacement;
  std::vector<double> increment(before.begin(), before.end());
  const auto state = scene.problem->state_at(unknowns);
  for (std::size_t i = 0; i < increment.size(); ++i)
    increment[i] = state.displacement[i] - increment[i];
  const double size = scene_size(scene.mesh);
  const double area = scene.mesh.dim == 2 && scene.deck.space != Space::Axisymmetric ? size : size * size;
  // What may be rounding of large displacements, or what the solver leaves of earlier forces, is no imbalance.
  const double force_floor =
      std::max({rounding_strain * softest(scene) * area, scene.problem->rounding() / deck.balance,
                unloaded_ratio * scene.problem->largest_force()});
  return certify({.mesh = scene.mesh,
                  .space = scene.deck.space,
                  .displacement = state.displacement,
                  .increment = increment,
                  .pairs = pairs,
                  .samples = samples,
                  .external_forces = forces,
                  .supports = supports,
                  .energy = {.stored = ledger.stored_energy(),
                             .dissipated = ledger.dissipated_energy(),
                             .external_work = ledger.external_work(),
                             .artificial = ledger.artificial_work(),
                             .work_uncertainty = ledger.work_uncertainty(),
                             .virtual_work_defect = ledger.virtual_work_defect(),
                             .virtual_work_scale = ledger.virtual_work_scale()},
                  .tolerances = {.penetration = deck.penetration,
                                 .tension = deck.tension,
                                 .complementarity = deck.complementarity,
                                 .balance = deck.balance,
                                 .energy = deck.energy,
                                 .volume_ratio = deck.volume_ratio,
                                 .friction = deck.friction,
                                 .slip = deck.slip,
                                 .artificial = deck.artificial},
                  .force_floor = force_floor,
                  .energy_floor = rounding_strain * force_floor * size,
                  .kinematics = scene.deck.kinematics});
}

bool CertificateRecord::add(const Certificate& certificate, double time) {
  if (worst_.empty())
    for (const auto& item : certificate.items)
      worst_.push_back({item, time});
  for (std::size_t i = 0; i < worst_.size(); ++i) {
    const auto& item = certificate.items[i];
    auto& worst = worst_[i];
    // The smallest volume ratio is the worst one; of all others the largest value. A failure beats any pass.
    const bool larger = item.name == "volume_ratio" ? item.value < worst.item.value : item.value > worst.item.value;
    if ((worst.item.passed && !item.passed) || (worst.item.passed == item.passed && larger)) worst = {item, time};
  }
  if (!certificate.passed()) ++failed_increments_;
  return certificate.passed();
}

nlohmann::ordered_json CertificateRecord::to_json() const {
  nlohmann::ordered_json json;
  json["passed"] = passed();
  json["failed_increments"] = failed_increments_;
  for (const auto& [item, time] : worst_)
    json["items"][item.name] = {{"worst", item.value},
                                {"tolerance", item.tolerance},
                                {"passed", item.passed},
                                {"time", time},
                                {"where", item.where}};
  return json;
}

std::vector<std::string> CertificateRecord::failures(const Deck& deck) const {
  std::vector<std::string> lines;
  for (const auto& [item, time] : worst_) {
    if (item.passed) continue;
    lines.push_back(formatted("%s is %.3g at t = %g, allowed %.3g%s%s", item.name.c_str(), item.value, time,
                              item.tolerance, item.where.empty() ? "" : ": ", item.where.c_str()));
    lines.back() += advice(item, deck);
  }
  return lines;
}

} // namespace amontons
