#include "material/hardening.hpp"

#include "deck/shared_rule.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {
namespace {

/// The index i of the table's line from point i to point i + 1 that holds p; the last point's index after the end.
std::size_t line_at(const TabulatedHardening& table, double p) {
  const auto& strains = table.plastic_strain;
  const auto after = std::upper_bound(strains.begin(), strains.end(), p) - strains.begin();
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
}

void check_table(const DeckNode& node, const TabulatedHardening& table, Reading& reading) {
  const auto& strains = table.plastic_strain;
  const auto& stresses = table.yield_stress;
  const auto fail = [&](const std::string& what) { reading.fail(node.place, node.path + " must have " + what); };
  if (strains.size() != stresses.size())
    fail("as many values of yield_stress as of plastic_strain, but has " + std::to_string(stresses.size()) + " and " +
         std::to_string(strains.size()) + ".");
  if (strains[0] != 0) fail("plastic_strain 0 first: its stress is where yielding begins.");
  if (std::adjacent_find(strains.begin(), strains.end(), std::greater_equal<>()) != strains.end())
    fail("plastic_strain increasing.");
  if (!std::is_sorted(stresses.begin(), stresses.end()))
    fail("yield_stress that never falls: with softening the result would depend on the mesh.");
}

Rule<LinearHardening> linear_rule() {
  using Law = LinearHardening;
  return ObjectRule<Law>()
      .required("yield", &Law::yield, number("stress", Range::above(0)), "Yield stress.")
      .optional("H", &Law::H, number("stress", Range::at_least(0)),
                "Slope of true stress over plastic strain; 0: perfect plasticity.");
}

Rule<SwiftHardening> swift_rule() {
  using Law = SwiftHardening;
  return ObjectRule<Law>()
      .required("K", &Law::K, number("stress", Range::above(0)), "Strength coefficient.")
      .required("eps_0", &Law::eps_0, number("1", Range::above(0)), "Strain offset; the yield stress is K eps_0^n.")
      .required("n", &Law::n, number("1", Range::between(0, 1)), "Hardening exponent.");
}

Rule<VoceHardening> voce_rule() {
  using Law = VoceHardening;
  return ObjectRule<Law>()
      .required("yield", &Law::yield, number("stress", Range::above(0)), "Initial yield stress.")
      .required("Q", &Law::Q, number("stress", Range::at_least(0)), "Rise of the yield stress until saturation.")
      .required("b", &Law::b, number("1", Range::above(0)), "Rate of saturation.")
      .optional("H", &Law::H, number("stress", Range::at_least(0)), "Slope that remains after saturation.");
}

Rule<TabulatedHardening> table_rule() {
  using Law = TabulatedHardening;
  return ObjectRule<Law>()
      .required("plastic_strain", &Law::plastic_strain, list_of(number("1", Range::at_least(0)), 1),
                "Accumulated plastic (logarithmic) strains, increasing from 0.")
      .required("yield_stress", &Law::yield_stress, list_of(number("stress", Range::above(0)), 1),
                "True yield stresses at these strains; constant after the last one.")
      .check(check_table);
}

} // namespace

double SwiftHardening::stress(double p) const { return K * std::pow(eps_0 + p, n); }
double SwiftHardening::slope(double p) const { return n * K * std::pow(eps_0 + p, n - 1); }
double SwiftHardening::work(double from, double to) const {
  return K / (n + 1) * (std::pow(eps_0 + to, n + 1) - std::pow(eps_0 + from, n + 1));
}

double VoceHardening::stress(double p) const { return yield - Q * std::expm1(-b * p) + H * p; }
double VoceHardening::slope(double p) const { return Q * b * std::exp(-b * p) + H; }
double VoceHardening::work(double from, double to) const {
  const double saturated = (to - from) + std::exp(-b * from) * std::expm1(-b * (to - from)) / b;
  return (to - from) * (yield + 0.5 * H * (from + to)) + Q * saturated;
}

double TabulatedHardening::slope(double p) const {
  const std::size_t i = line_at(*this, p);
  if (i + 1 == plastic_strain.size()) return 0;
  return (yield_stress[i + 1] - yield_stress[i]) / (plastic_strain[i + 1] - plastic_strain[i]);
}
double TabulatedHardening::stress(double p) const {
  const std::size_t i = line_at(*this, p);
  return yield_stress[i] + slope(p) * (p - plastic_strain[i]);
}
double TabulatedHardening::work(double from, double to) const {
  double work = 0, p = from;
  for (std::size_t i = line_at(*this, from); p < to; ++i) {
    const double end = i + 1 < plastic_strain.size() ? std::min(plastic_strain[i + 1], to) : to;
    work += (end - p) * (stress(p) + 0.5 * slope(p) * (end - p));
    p = end;
  }
  return work;
}

double yield_stress(const Hardening& hardening, double p) {
  return std::visit([p](const auto& law) { return law.stress(p); }, hardening);
}
double hardening_slope(const Hardening& hardening, double p) {
  return std::visit([p](const auto& law) { return law.slope(p); }, hardening);
}
double hardening_work(const Hardening& hardening, double from, double to) {
  return std::visit([=](const auto& law) { return law.work(from, to); }, hardening);
}

Rule<Hardening> hardening_rule() {
  return TaggedRule<Hardening>()
      .tag("linear", shared(linear_rule()), "Straight line, or perfect plasticity.")
      .tag("swift", shared(swift_rule()), "Power law K (eps_0 + p)^n.",
           "H. W. Swift, J. Mech. Phys. Solids 1 (1952) 1-18.")
      .tag("voce", shared(voce_rule()), "Exponential saturation, with a linear term if wanted.",
           "E. Voce, J. Inst. Met. 74 (1948) 537-562.")
      .tag("table", shared(table_rule()), "Straight lines between given points.");
}

} // namespace amontons
