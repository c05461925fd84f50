#include "accuracy/certificate.hpp"

#include "accuracy/checks.hpp"
#include "accuracy/facet_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace amontons {

namespace {

using accuracy::Worst;

void check_fits(const CertificateInput& input) {
  const std::size_t size = std::size_t(input.mesh.num_local()) * input.mesh.dim;
  if (input.displacement.size() != size || input.increment.size() != size || input.external_forces.size() != size)
    throw std::invalid_argument(
        "certify: displacement, increment and external_forces need dim values for each local node");
  if (input.samples.size() != input.pairs.size())
    throw std::invalid_argument("certify: there must be as many samples as pairs");
  for (std::size_t pair = 0; pair < input.pairs.size(); ++pair)
    if (input.samples[pair].has_friction != input.pairs[pair].friction.has_value())
      throw std::invalid_argument("certify: samples have friction if and only if their pair has a law");
}

Certificate::Item at_most(std::string name, const Worst& worst, double tolerance) {
  return {std::move(name), worst.value, tolerance, worst.value <= tolerance, worst.where};
}

/// |part| / scale, with 0 / 0 = 0 and what is not a number as the worst value.
double relative(double part, double scale) {
  if (part == 0.0) return 0.0;
  const double ratio = std::abs(part) / scale;
  return ratio <= accuracy::no_value ? ratio : accuracy::no_value;
}

Certificate::Item virtual_work_item(const CertificateInput& input) {
  const EnergyLedger& energy = input.energy;
  const double value = relative(energy.virtual_work_defect, std::max(energy.virtual_work_scale, input.energy_floor));
  return at_most("virtual_work", {value, ""}, input.tolerances.energy);
}

double energy_scale(const CertificateInput& input) {
  return std::max({std::abs(input.energy.external_work), std::abs(input.energy.stored), input.energy_floor});
}

Certificate::Item artificial_item(const CertificateInput& input) {
  return at_most("artificial", {relative(input.energy.artificial, energy_scale(input)), ""},
                 input.tolerances.artificial);
}

Certificate::Item energy_item(const CertificateInput& input) {
  const EnergyLedger& energy = input.energy;
  const double gap = energy.external_work - energy.stored - energy.dissipated - energy.artificial;
  const double excess = std::abs(gap) - energy.work_uncertainty;
  const double scale = energy_scale(input);
  // Not std::max, which would drop an excess that is not a number.
  return at_most("energy", {excess <= 0.0 ? 0.0 : relative(excess, scale), ""}, input.tolerances.energy);
}

/// The certificate of a state that holds something that is not a number: nothing can be checked, everything fails.
Certificate without_numbers(const CertificateTolerances& limits) {
  Certificate certificate;
  const auto fail = [&](const char* name, double tolerance) {
    certificate.items.push_back({name, accuracy::no_value, tolerance, false, "displacements or forces are not finite"});
  };
  fail("penetration", limits.penetration);
  fail("tension", limits.tension);
  fail("complementarity", limits.complementarity);
  fail("left_master", limits.complementarity);
  fail("force_balance", limits.balance);
  fail("moment_balance", limits.balance);
  fail("body_balance", limits.balance);
  fail("virtual_work", limits.energy);
  fail("energy", limits.energy);
  fail("volume_ratio", limits.volume_ratio);
  fail("missed_contact", limits.penetration);
  fail("friction_cone", limits.friction);
  fail("slip", limits.slip);
  fail("dissipation", limits.friction);
  fail("artificial", limits.artificial);
  fail("supports", limits.supports);
  return certificate;
}

/// Does every rank have numbers to check? Collective.
bool is_finite(const CertificateInput& input) {
  const auto finite = [](double value) { return std::isfinite(value); };
  int all = std::all_of(input.displacement.begin(), input.displacement.end(), finite) &&
            std::all_of(input.external_forces.begin(), input.external_forces.end(), finite);
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, input.mesh.comm);
  return all != 0;
}

} // namespace

bool Certificate::passed() const {
  return std::all_of(items.begin(), items.end(), [](const Item& item) { return item.passed; });
}

Certificate certify(const CertificateInput& input) {
  check_fits(input);
  const Mesh& mesh = input.mesh;
  Box scene;
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    scene.include(mesh.position(node));
  for (const Box& box : accuracy::boxes_of_ranks(mesh.comm, std::span(&scene, 1)))
    scene.include(box);
  std::array<double, 3> pivot{};
  for (std::size_t c = 0; c < 3; ++c)
    pivot[c] = 0.5 * (scene.low[c] + scene.high[c]);

  if (!is_finite(input)) return without_numbers(input.tolerances);
  accuracy::ClaimedForces forces;
  const accuracy::GapChecks gaps = accuracy::check_gaps(input, pivot, forces);
  const Worst tension = accuracy::check_tension(input);
  const accuracy::BalanceChecks balance = accuracy::check_balance(input, pivot, scene.diagonal(), forces);
  const Worst volume = accuracy::check_volume(input);
  const Worst overlap = accuracy::check_overlap(input);
  const accuracy::FrictionChecks friction = accuracy::check_friction(input);
  const Worst supports = accuracy::check_supports(input);

  const CertificateTolerances& limits = input.tolerances;
  Certificate certificate;
  certificate.items = {
      at_most("penetration", gaps.penetration, limits.penetration),
      at_most("tension", tension, limits.tension),
      at_most("complementarity", gaps.complementarity, limits.complementarity),
      at_most("left_master", gaps.left_master, limits.complementarity),
      at_most("force_balance", balance.force, limits.balance),
      at_most("moment_balance", balance.moment, limits.balance),
      at_most("body_balance", balance.body, limits.balance),
      virtual_work_item(input),
      energy_item(input),
      {"volume_ratio", -volume.value, limits.volume_ratio, -volume.value > limits.volume_ratio, volume.where},
      at_most("missed_contact", overlap, limits.penetration),
      at_most("friction_cone", friction.cone, limits.friction),
      at_most("slip", friction.slip, limits.slip),
      at_most("dissipation", friction.dissipation, limits.friction),
      artificial_item(input),
      at_most("supports", supports, limits.supports)};
  return certificate;
}

} // namespace amontons
