#include "effects_audit.hpp"

#include "accuracy/absent_effects.hpp"
#include "base/timer.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

using Json = nlohmann::ordered_json;

/// Coefficient of friction that a frictionless pair is asked about: of lubricated metals (F. P. Bowden, D. Tabor, The
/// Friction and Lubrication of Solids, 1950).
constexpr double mu_of_lubricated_metal = 0.1;

Json entry(double indicator, double threshold, const char* meaning) {
  return {{"on", false},
          {"indicator", indicator},
          {"threshold", threshold},
          {"above_threshold", indicator > threshold},
          {"meaning", meaning}};
}

Json not_judged(const char* reason) {
  return {{"on", false}, {"indicator", nullptr}, {"above_threshold", false}, {"meaning", reason}};
}

/// A number of each body's material, in the order of Mesh::bodies; zero where it is not given.
template <class Number>
std::vector<double> of_bodies(const Scene& scene, Number number) {
  std::vector<double> values;
  for (const auto& body : scene.mesh.bodies)
    values.push_back(number(scene.deck.materials.at(scene.deck.bodies.at(body).value).value));
  return values;
}

bool any(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
}

std::vector<double> densities(const Scene& scene) {
  return of_bodies(scene, [](const MaterialDeck& material) { return material.density; });
}

Json plasticity(const AuditInput& input) {
  const auto yield =
      of_bodies(input.scene, [](const MaterialDeck& material) { return material.yield_stress.value_or(0.0); });
  if (!any(yield)) return not_judged("not judged: no material gives its yield_stress");
  const auto audit =
      audit_yield(*input.scene.bulk, input.scene.mesh, input.scene.problem->state_at(input.unknowns), yield);
  Json json = entry(audit.ratio, 1.0,
                    "largest von Mises stress at the end over the yield stress (R. von Mises, 1913); at points of "
                    "integration, so a little low on coarse meshes");
  if (audit.body >= 0) json["body"] = input.scene.mesh.bodies[audit.body];
  return json;
}

Json friction(const AuditInput& input) {
  const auto pairs = pair_names(input.scene);
  const auto state = input.scene.problem->state_at(input.unknowns);
  double left_out = 0.0;
  bool frictionless = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].friction) continue;
    frictionless = true;
    left_out += mu_of_lubricated_metal * sliding_work(input.scene.mesh, state.displacement, pairs[i], input.samples[i]);
  }
  if (!frictionless) return not_judged("not judged: no pair is without friction");
  const double work = std::max(std::abs(input.ledger.external_work()), input.ledger.stored_energy());
  return entry(work > 0.0 ? left_out / work : 0.0, 0.05,
               "what friction of mu = 0.1 (lubricated metal: Bowden and Tabor, 1950) would take on the way that the "
               "surfaces have slid over each other under their pressure at the end, over the work of the loads; the "
               "threshold is a choice");
}

Json inertia(const AuditInput& input) {
  if (!input.motion) return not_judged("not judged: no material gives its density");
  const double stored = input.ledger.stored_energy();
  Json json =
      entry(stored > 0.0 ? input.motion->largest_kinetic() / stored : 0.0, 0.05,
            "largest kinetic energy of an increment over the stored energy at the end, if t is a time in units that "
            "go with the density; 5 to 10 % is the usual limit of quasi-static analysis (Abaqus Analysis User's "
            "Guide, Explicit dynamic analysis, energy balance)");
  json["largest_body_speed_over_wave_speed"] = input.motion->largest_speed();
  return json;
}

Json heat(const AuditInput& input) {
  const auto capacity = of_bodies(input.scene, [](const MaterialDeck& material) {
    return material.density * material.heat_capacity.value_or(0.0);
  });
  if (!any(capacity)) return not_judged("not judged: no material gives density and heat_capacity");
  const auto state = input.scene.problem->state_at(input.unknowns);
  const auto volumes = body_volumes(*input.scene.bulk, input.scene.mesh, state);
  double total = 0.0;
  for (std::size_t b = 0; b < volumes.size(); ++b)
    total += capacity[b] * volumes[b];
  return entry(
      input.ledger.dissipated_energy() / total, 10.0,
      "heat that friction has generated over the heat capacity of the bodies that give one: their mean rise of "
      "temperature if nothing is lost (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 1959, 1.6), in "
      "degrees; near the surface it is more. The threshold is a choice");
}

} // namespace

bool MotionRecord::wanted(const Deck& deck) {
  return std::any_of(deck.materials.begin(), deck.materials.end(),
                     [](const auto& material) { return material.second.value.density > 0.0; });
}

void MotionRecord::add(Scene& scene, Vec accepted, Vec unknowns) {
  const Phase phase("error estimate");
  const double dt = scene.problem->time() - scene.problem->accepted_time();
  if (dt <= 0.0) return;
  const auto before = scene.problem->state_at(accepted).displacement;
  std::vector<double> increment(before.begin(), before.end());
  const auto now = scene.problem->state_at(unknowns).displacement;
  for (std::size_t i = 0; i < increment.size(); ++i)
    increment[i] = now[i] - increment[i];
  const auto density = densities(scene);
  std::vector<double> wave_speed;
  for (std::size_t b = 0; b < density.size(); ++b)
    wave_speed.push_back(density[b] > 0.0 ? std::sqrt(scene.bulk->stiffness(static_cast<std::int32_t>(b)) / density[b])
                                          : 0.0);
  const auto audit = audit_motion(scene.mesh, scene.deck.space, increment, dt, density, wave_speed);
  kinetic_ = std::max(kinetic_, audit.kinetic);
  speed_ = std::max(speed_, audit.largest_speed);
}

nlohmann::ordered_json audit_absent_effects(const AuditInput& input) {
  const Phase phase("error estimate");
  return {{"plasticity", plasticity(input)},
          {"friction", friction(input)},
          {"inertia", inertia(input)},
          {"heat", heat(input)}};
}

} // namespace amontons
