// One law of each kind with parameters of order one, and random states for them.
#pragma once

#include "friction/friction_law.hpp"

#include <array>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace amontons {

struct SampleLaw {
  std::string name;
  FrictionLaw law;
};

inline std::vector<SampleLaw> sample_laws() {
  RateAndState slip_law{.mu = 0.6, .a = 0.015, .b = 0.02, .L = 0.5, .v0 = 0.3, .theta_initial = 0.4};
  RateAndState ageing_law = slip_law;
  ageing_law.evolution = StateEvolution::Ageing;
  RateAndState cohesive_ageing_law = ageing_law;
  cohesive_ageing_law.cohesion = 0.3;
  return {{"tresca", Tresca{.tau_max = 0.7}},
          {"coulomb", Coulomb{.mu = 0.4, .cohesion = 0.2}},
          {"orowan", Orowan{.mu = 0.4, .tau_max = 0.9, .cohesion = 0.1}},
          {"shaw", Shaw{.mu = 0.4, .tau_max = 0.9, .cohesion = 0.1}},
          {"static_kinetic", StaticKinetic{.mu_s = 0.5, .mu_k = 0.3, .cohesion = 0.1}},
          {"velocity_weakening", VelocityWeakening{.mu_s = 0.5, .mu_k = 0.2, .v_c = 0.7, .cohesion = 0.1}},
          {"weakening_strengthening",
           WeakeningStrengthening{.mu_s = 0.5, .mu_k = 0.2, .v_c = 0.4, .kappa = 0.2, .cohesion = 0.1}},
          {"slip_weakening", SlipWeakening{.mu_s = 0.5, .mu_k = 0.2, .D_c = 1.5, .cohesion = 0.1}},
          {"rate_and_state, slip law", slip_law},
          {"rate_and_state, ageing law", ageing_law},
          {"rate_and_state, ageing law with cohesion", cohesive_ageing_law},
          {"prakash_clifton", PrakashClifton{.mu = 0.5, .L = 0.6, .creep_rate = 0.1, .cohesion = 0.1}}};
}

/// Random increments and states that the law can really have.
class RandomPoint {
 public:
  explicit RandomPoint(unsigned seed) : random_(seed) {}

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool with_chance(double chance) { return between(0, 1) < chance; }
  /// dt is zero once in ten times.
  FrictionContext context() { return {.dt = with_chance(0.1) ? 0.0 : between(0.1, 2), .factor = between(0.2, 1.5)}; }
  /// The state after sliding by a random amount at a random pressure.
  FrictionState state(const FrictionLaw& law) {
    FrictionContext begin = context();
    begin.new_contact = true;
    return friction_limit(law, begin, between(0.5, 5), with_chance(0.2) ? 0.0 : between(0.01, 2), {}).state;
  }
  std::array<double, 3> vector(int dim, double size) {
    std::array<double, 3> v{};
    for (int i = 0; i < dim; ++i)
      v[i] = between(-size, size);
    return v;
  }

 private:
  std::mt19937 random_;
};

} // namespace amontons
