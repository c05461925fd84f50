#include "friction/friction_law.hpp"

#include "deck/shared_rule.hpp"

namespace amontons {

FrictionState initial_state(const FrictionLaw& law, const FrictionContext& context, double p) {
  return std::visit(
      [&](const auto& one) -> FrictionState {
        if constexpr (requires { one.initial_state(context, p); })
          return one.initial_state(context, p);
        else
          return {};
      },
      law);
}

FrictionLimit friction_limit(const FrictionLaw& law, const FrictionContext& context, double p, double s,
                             const FrictionState& state_old) {
  const FrictionState old = context.new_contact ? initial_state(law, context, p) : state_old;
  return std::visit([&](const auto& one) { return one.limit(context, p, s, old); }, law);
}

double steepest_weakening(const FrictionLaw& law, const FrictionContext& context, double p, double s_max,
                          const FrictionState& state_old) {
  const FrictionState old = context.new_contact ? initial_state(law, context, p) : state_old;
  return std::visit(
      [&](const auto& one) -> double {
        if constexpr (requires { one.steepest_weakening(context, p, s_max, old); })
          return one.steepest_weakening(context, p, s_max, old);
        else
          return 0;
      },
      law);
}

std::span<const std::string_view> state_names(const FrictionLaw& law) {
  return std::visit(
      []<class Law>(const Law&) -> std::span<const std::string_view> {
        if constexpr (requires { Law::state_names; })
          return Law::state_names;
        else
          return {};
      },
      law);
}

Rule<FrictionLaw> friction_law_rule() {
  TaggedRule<FrictionLaw> rule;
  rule.tag("coulomb", coulomb_rule(), "Proportional to the pressure.")
      .tag("tresca", tresca_rule(), "Constant shear limit.")
      .tag("orowan", orowan_rule(), "Proportional to the pressure up to a maximum shear.",
           "E. Orowan, Proc. Inst. Mech. Eng. 150 (1943) 140-167.")
      .tag("shaw", shaw_rule(), "Smooth saturation with pressure towards a maximum shear.",
           "M. C. Shaw, A. Ber, P. A. Mamin, J. Basic Eng. 82 (1960) 342-345.")
      .tag("static_kinetic", static_kinetic_rule(), "A coefficient at rest and a smaller one in motion.")
      .tag("velocity_weakening", velocity_weakening_rule(), "Weakens smoothly with the slip rate.",
           "L. C. Bo, D. Pavelescu, Wear 82 (1982) 277-289.")
      .tag("weakening_strengthening", weakening_strengthening_rule(),
           "Weakens with the slip rate, strengthens at high rates.",
           "B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083-1138.")
      .tag("slip_weakening", slip_weakening_rule(), "Weakens linearly over a critical slip distance.",
           "Y. Ida, J. Geophys. Res. 77 (1972) 3796-3805.")
      .tag("rate_and_state", rate_and_state_rule(), "Depends on the logarithm of the slip rate and on a state.",
           "A. Ruina, J. Geophys. Res. 88 (1983) 10359-10370; J. R. Rice, Y. Ben-Zion, PNAS 93 (1996) 3811-3818.")
      .tag("prakash_clifton", prakash_clifton_rule(), "Follows a change of pressure only with slip.",
           "A. Cochard, J. R. Rice, J. Geophys. Res. 105 (2000) 25891-25907.");
  return shared(Rule<FrictionLaw>(rule));
}

} // namespace amontons
