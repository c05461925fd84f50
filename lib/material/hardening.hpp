// Isotropic hardening: the yield stress as a function of the accumulated plastic strain, in several forms. Each has its
// value, slope and integral; the flow rules do not know which one it is.
#pragma once

#include <variant>
#include <vector>

namespace amontons {

template <class T>
struct Rule;

/// σ_y = yield + H p.
struct LinearHardening {
  double yield = 1.0; // stress, > 0
  double H = 0.0;     // stress, >= 0; 0: perfect plasticity

  double stress(double p) const { return yield + H * p; }
  double slope(double) const { return H; }
  double work(double from, double to) const { return (to - from) * (yield + 0.5 * H * (from + to)); }
};

/// σ_y = K (eps_0 + p)^n; the yield stress is K eps_0^n. H. W. Swift, J. Mech. Phys. Solids 1 (1952) 1-18.
struct SwiftHardening {
  double K = 1.0;     // stress, > 0
  double eps_0 = 1.0; // strain, > 0
  double n = 0.0;     // 0 <= n <= 1

  double stress(double p) const;
  double slope(double p) const;
  double work(double from, double to) const;
};

/// σ_y = yield + Q (1 − e^(−b p)) + H p. E. Voce, J. Inst. Met. 74 (1948) 537-562; with the linear term the saturation
/// law of J. C. Simo, Comput. Methods Appl. Mech. Eng. 68 (1988) 1-31.
struct VoceHardening {
  double yield = 1.0; // stress, > 0
  double Q = 0.0;     // stress, >= 0
  double b = 1.0;     // 1, > 0
  double H = 0.0;     // stress, >= 0

  double stress(double p) const;
  double slope(double p) const;
  double work(double from, double to) const;
};

/// Straight lines between points; constant after the last one. At a point the slope is that of the line that follows.
struct TabulatedHardening {
  std::vector<double> plastic_strain{0.0}; // increasing from 0
  std::vector<double> yield_stress{1.0};   // > 0, never falling; as many

  double stress(double p) const;
  double slope(double p) const;
  double work(double from, double to) const;
};

using Hardening = std::variant<LinearHardening, SwiftHardening, VoceHardening, TabulatedHardening>;

/// σ_y(p), true stress; p >= 0 is the accumulated plastic strain ∫ √(2/3 d_p : d_p) dt.
double yield_stress(const Hardening& hardening, double p);
/// dσ_y/dp >= 0.
double hardening_slope(const Hardening& hardening, double p);
/// ∫ σ_y dp between two plastic strains: energy per volume that flow without viscosity takes.
double hardening_work(const Hardening& hardening, double from, double to);

/// `{linear: {yield: 250}}` and so on.
Rule<Hardening> hardening_rule();

} // namespace amontons
