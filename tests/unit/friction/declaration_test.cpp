// The laws as a deck writes them: every tag, defaults, ranges, keys of another law.
#include "../deck/read.hpp"
#include "friction/friction_law.hpp"

#include <doctest/doctest.h>

using namespace amontons;

TEST_CASE("each tag gives its law with its parameters") {
  const auto rule = friction_law_rule();
  const auto coulomb = std::get<Coulomb>(read_well("{coulomb: {mu: 0.3}}", rule));
  CHECK(coulomb.mu == 0.3);
  CHECK(coulomb.cohesion == 0);
  CHECK(std::get<Tresca>(read_well("{tresca: {tau_max: 60}}", rule)).tau_max == 60);
  const auto orowan = std::get<Orowan>(read_well("{orowan: {mu: 0.3, tau_max: 60, cohesion: 5}}", rule));
  CHECK(orowan.mu == 0.3);
  CHECK(orowan.tau_max == 60);
  CHECK(orowan.cohesion == 5);
  CHECK(std::get<Shaw>(read_well("{shaw: {mu: 0.3, tau_max: 60}}", rule)).tau_max == 60);
  const auto drop = std::get<StaticKinetic>(read_well("{static_kinetic: {mu_s: 0.5, mu_k: 0.3}}", rule));
  CHECK(drop.mu_s == 0.5);
  CHECK(drop.mu_k == 0.3);
  const auto smooth =
      std::get<VelocityWeakening>(read_well("{velocity_weakening: {mu_s: 0.5, mu_k: 0.3, v_c: 2}}", rule));
  CHECK(smooth.v_c == 2);
  const auto stribeck = std::get<WeakeningStrengthening>(
      read_well("{weakening_strengthening: {mu_s: 0.5, mu_k: 0.3, v_c: 2, kappa: 0.01}}", rule));
  CHECK(stribeck.kappa == 0.01);
  CHECK(std::get<SlipWeakening>(read_well("{slip_weakening: {mu_s: 0.5, mu_k: 0.3, D_c: 0.4}}", rule)).D_c == 0.4);
  const auto rock = std::get<RateAndState>(
      read_well("{rate_and_state: {mu: 0.6, a: 0.01, b: 0.015, L: 1e-5, v0: 1e-6, evolution: ageing}}", rule));
  CHECK(rock.a == 0.01);
  CHECK(rock.b == 0.015);
  CHECK(rock.L == 1e-5);
  CHECK(rock.v0 == 1e-6);
  CHECK(rock.theta_initial == 0);
  CHECK(rock.evolution == StateEvolution::Ageing);
  const auto memory =
      std::get<PrakashClifton>(read_well("{prakash_clifton: {mu: 0.6, L: 1e-4, creep_rate: 1e-9}}", rule));
  CHECK(memory.L == 1e-4);
  CHECK(memory.creep_rate == 1e-9);
}

TEST_CASE("wrong parameters are refused at their place") {
  const auto rule = friction_law_rule();
  check_refused("{coulomb: {mu: -0.1}}", rule, "f:1:16: ", ">= 0");
  check_refused("{coulomb: {}}", rule, "f:1:11: ", "mu");
  check_refused("{coulomb: {mu: 0.3, tau_max: 5}}", rule, "f:1:21: ", "tau_max");
  check_refused("{columb: {mu: 0.3}}", rule, "f:1:2: ", "coulomb");
  check_refused("{orowan: {mu: 0.3, tau_max: 5, cohesion: 6}}", rule, "f:1:10: ", "cohesion <= tau_max");
  check_refused("{shaw: {mu: 0.3, tau_max: 5, cohesion: 5}}", rule, "f:1:8: ", "cohesion < tau_max");
  check_refused("{static_kinetic: {mu_s: 0.2, mu_k: 0.3}}", rule, "f:1:18: ", "mu_k <= mu_s");
  check_refused("{velocity_weakening: {mu_s: 0.3, mu_k: 0.2, v_c: 0}}", rule, "f:1:50: ", "> 0");
  check_refused("{slip_weakening: {mu_s: 0.3, mu_k: 0.2, D_c: -1}}", rule, "f:1:46: ", "> 0");
  check_refused("{rate_and_state: {mu: 0.6, a: 0, b: 0.01, L: 1, v0: 1}}", rule, "f:1:31: ", "> 0");
  check_refused("{rate_and_state: {mu: 0.6, a: 0.01, b: 0.01, L: 0, v0: 1}}", rule, "f:1:49: ", "> 0");
  check_refused("{rate_and_state: {mu: 0.6, a: 0.01, b: 0.01, L: 1, v0: 1, evolution: aging}}", rule,
                "f:1:70: ", "ageing");
  check_refused("{prakash_clifton: {mu: 0.6, L: 0}}", rule, "f:1:32: ", "> 0");
}
