#include "material/radial_return.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace amontons {
namespace {

/// The scalar equation of the return.
struct FlowEquation {
  const Hardening& hardening;
  double q;         // of the trial state
  double stiffness; // 3 G + H_kin
  double p;         // at the start
};

/// Its solution.
struct Flow {
  double p_increment;
  double slope;      // h
  double overstress; // above σ_y at the end
};

struct ValueSlope {
  double value, slope;
};

/// The zero of a falling function between low and high, by Newton's method from `start`; a step that leaves the bracket
/// is replaced by one to its middle. Ends at rounding: the value within `tolerance`, or no number left in the bracket.
template <class Function>
std::optional<double> falling_root(const Function& function, double low, double high, double start, double tolerance) {
  double x = start;
  for (int i = 0; i < 200; ++i) {
    const ValueSlope at = function(x);
    if (std::abs(at.value) <= tolerance) return x;
    (at.value > 0 ? low : high) = x;
    const double newton = x - at.value / at.slope;
    const double next = newton > low && newton < high ? newton : low + 0.5 * (high - low);
    if (next == low || next == high) return x;
    x = next;
  }
  return std::nullopt;
}

/// A few roundings of the largest term.
double tolerance(const FlowEquation& equation) { return 1e-15 * equation.q; }

/// Above this Δp the stress would be below the yield stress that there was at the start.
double largest_increment(const FlowEquation& equation) {
  return (equation.q - yield_stress(equation.hardening, equation.p)) / equation.stiffness;
}

/// Yield stresses that curve downwards make Newton's method from Δp = 0 converge from one side. The bracket ends at
/// twice the largest increment because perfect plasticity has its root at that very place.
std::optional<Flow> solve_without_rate(const FlowEquation& equation) {
  const auto overshoot = [&](double x) -> ValueSlope {
    const double p = equation.p + x;
    return {equation.q - equation.stiffness * x - yield_stress(equation.hardening, p),
            -equation.stiffness - hardening_slope(equation.hardening, p)};
  };
  const auto x = falling_root(overshoot, 0, 2 * largest_increment(equation), 0, tolerance(equation));
  if (!x) return std::nullopt;
  return Flow{*x, hardening_slope(equation.hardening, equation.p + *x), 0};
}

/// The unknown is y = (Δp / (D dt))^(1/n) = overstress / σ_y: in Δp the right-hand side would rise with infinite slope.
std::optional<Flow> solve_perzyna(const FlowEquation& equation, const Perzyna& law, double dt) {
  const double scale = law.D * dt;
  const auto overshoot = [&](double y) -> ValueSlope {
    const double x = scale * std::pow(y, law.n), dx = law.n * scale * std::pow(y, law.n - 1), p = equation.p + x;
    const double yield = yield_stress(equation.hardening, p);
    return {equation.q - equation.stiffness * x - yield * (1 + y),
            -equation.stiffness * dx - hardening_slope(equation.hardening, p) * dx * (1 + y) - yield};
  };
  const double by_yield = equation.q / yield_stress(equation.hardening, equation.p) - 1;
  const double by_stiffness = std::pow(largest_increment(equation) / scale, 1 / law.n);
  const double high = std::min(by_yield, by_stiffness);
  const auto y = falling_root(overshoot, 0, high, high, tolerance(equation));
  if (!y) return std::nullopt;
  const double x = scale * std::pow(*y, law.n), yield = yield_stress(equation.hardening, equation.p + x);
  if (!(x > 0)) return Flow{0, 0, 0};
  return Flow{x, hardening_slope(equation.hardening, equation.p + x) * (1 + *y) + yield * *y / (law.n * x), yield * *y};
}

std::optional<Flow> solve(const ElasticPlastic& material, const FlowEquation& equation, double dt) {
  if (!material.rate) return solve_without_rate(equation);
  if (!(dt > 0)) return Flow{0, 0, 0};
  return std::visit([&](const Perzyna& law) { return solve_perzyna(equation, law, dt); }, *material.rate);
}

} // namespace

RadialReturn radial_return(const ElasticPlastic& material, const PointContext& context, const Trial& trial) {
  const auto [lambda, G] = lame_constants(material.elastic, Space::Solid);
  const double bulk = lambda + 2.0 / 3 * G, H = kinematic_modulus(material);
  const double volume = trial.elastic_strain.trace();
  Tensor shear_strain = deviator(trial.elastic_strain), plastic_strain = trial.plastic_strain;
  const Tensor relative = 2 * G * shear_strain - 2.0 / 3 * H * plastic_strain; // s − β of the trial state
  const double norm = relative.norm(), q = std::sqrt(1.5) * norm;
  RadialReturn result;
  result.moduli = {.bulk = bulk, .shear = 2 * G};
  if (q > yield_stress(material.hardening, trial.p) * (1 + 1e-12) + 3e-14 * G) {
    const double stiffness = 3 * G + H;
    const auto flow = solve(material, {material.hardening, q, stiffness, trial.p}, context.dt);
    result.is_converged = flow.has_value();
    if (flow && flow->p_increment > 0) {
      const Tensor n = relative / norm;
      const double x = flow->p_increment, share = 3 * G * x / q;
      result.p_increment = x;
      result.flow = std::sqrt(1.5) * x * n;
      result.moduli = {.bulk = bulk,
                       .shear = 2 * G * (1 - share),
                       .drop = 2 * G * (3 * G / (stiffness + flow->slope) - share),
                       .flow = n};
      result.dissipated = hardening_work(material.hardening, trial.p, trial.p + x) + flow->overstress * x;
      shear_strain -= result.flow;
      plastic_strain += result.flow;
    }
  }
  result.stress = bulk * volume * Tensor::Identity() + 2 * G * shear_strain;
  result.stored = 0.5 * bulk * volume * volume + G * shear_strain.squaredNorm() + H / 3 * plastic_strain.squaredNorm();
  return result;
}

} // namespace amontons
