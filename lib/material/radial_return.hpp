// The flow rule of von Mises over one increment: from a trial elastic strain back to the yield surface. Small and
// finite strain share it; they differ only in what the strain is.
#pragma once

#include "material/elastic_plastic.hpp"
#include "material/log_strain.hpp"

namespace amontons {

/// What the trial state is: elastic strain if all of the increment were elastic, and what was remembered.
struct Trial {
  Tensor elastic_strain;
  Tensor plastic_strain = Tensor::Zero(); // only its product with the kinematic modulus is used
  double p = 0.0;                         // accumulated plastic strain
};

struct RadialReturn {
  Tensor stress = Tensor::Zero();
  Tensor flow = Tensor::Zero(); // plastic strain increment, trace-free; zero in elastic increments
  double p_increment = 0.0;     // √(2/3 flow : flow)
  double stored = 0.0;          // elastic energy and that of the backstress
  double dissipated = 0.0;      // (q + overstress) dp, see below; >= 0
  FlowModuli moduli;            // dT/d(elastic_strain of the trial), consistent with the increment
  bool is_converged = true;
};

/// Backward Euler of  dε_p = √(3/2) n dp,  n = (s − β) / |s − β|,  q = √(3/2) |s − β| <= σ_y(p):
///   q_trial − (3 G + H_kin) Δp = σ_y(p + Δp) (1 + (Δp / (D Δt))^(1/n)),  n = n_trial,
/// one scalar equation with one solution, by a safeguarded Newton iteration (bracketed; to rounding). In the viscous
/// case its unknown is the overstress, for which the equation has a finite slope at rest. Moduli, with h the total
/// derivative of the right-hand side:
///   shear = 2 G (1 − 3 G Δp / q_trial),  drop = 2 G (3 G / (3 G + H_kin + h) − 3 G Δp / q_trial).
/// Dissipated: ∫ σ_y dp + overstress Δp; work = stored + dissipated holds to second order in the increment without
/// viscosity and to first order with it. An overshoot of yield by rounding (1e-12 of it, or 1e-14 in strain) counts as
/// elastic, lest chance decide between elastic and plastic moduli at the start of an increment.
///
/// J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), ch. 3.
RadialReturn radial_return(const ElasticPlastic& material, const PointContext& context, const Trial& trial);

} // namespace amontons
