// Elastoplasticity after von Mises at finite strain.
#pragma once

#include "material/elastic_plastic.hpp"
#include "material/point.hpp"

#include <array>
#include <string_view>

namespace amontons {

/// F = F_e F_p (multiplicative split), F_e = R U, Hencky elasticity in E = ln U:
///   T = K tr(E) 1 + 2 G dev E,  τ = R T R^T,  P = τ F^-T.
/// Increment: trial F_e = F F_p,old^-1, radial_return of E_trial gives E and the plastic increment ΔN, then
///   F_p^-1 = F_p,old^-1 U_trial^-1 exp(E):
/// where ΔN has the axes of E_trial (always without kinematic hardening) this is the exponential map
/// F_p = exp(ΔN) F_p,old without plastic spin. Plastic flow keeps the volume to rounding, and evaluating the same F
/// again from the new state gives the same stress.
///
/// Kinematic hardening: β = 2/3 H ∫ D_p dt in the same rotated axes as T (they turn with F_e; with small elastic
/// strains this is Jaumann's rate of β). There the plastic spin of the step is of the order of E dp, and the tangent is
/// not symmetric, to the same order. In simple shear such backstress turns round and the shear stress wavers, τ_xy ~
/// H/3 sin γ: meant for Bauschinger effects at shears below about 1, not for large shear in one direction.
///
/// State: p, F_p^-1 (nine, row by row), with kinematic hardening also ∫ D_p dt (six, engineering shears).
///
/// G. Weber, L. Anand, Comput. Methods Appl. Mech. Eng. 79 (1990) 173-202; A. L. Eterovic, K.-J. Bathe, Int. J. Numer.
/// Methods Eng. 30 (1990) 1099-1114; J. C. Simo, Comput. Methods Appl. Mech. Eng. 99 (1992) 61-112; on shear with
/// kinematic hardening: J. C. Nagtegaal, J. E. de Jong, Proc. Workshop Plasticity of Metals at Finite Strain, Stanford
/// (1982) 65-102.
struct FinitePlastic {
  ElasticPlastic material;
  static constexpr std::array<std::string_view, 16> all_state_names{
      "accumulated_plastic_strain",  "plastic_gradient_inverse_xx",
      "plastic_gradient_inverse_xy", "plastic_gradient_inverse_xz",
      "plastic_gradient_inverse_yx", "plastic_gradient_inverse_yy",
      "plastic_gradient_inverse_yz", "plastic_gradient_inverse_zx",
      "plastic_gradient_inverse_zy", "plastic_gradient_inverse_zz",
      "plastic_strain_xx",           "plastic_strain_yy",
      "plastic_strain_zz",           "plastic_strain_xy",
      "plastic_strain_yz",           "plastic_strain_zx"};

  std::span<const std::string_view> names() const;
  void initial_state(std::span<double> state) const;
  FiniteResponse respond(const PointContext& context, const Tensor& F, std::span<const double> state_old,
                         std::span<double> state_new) const;
  /// dP/dF at the end of the increment.
  PointOutcome tangent(const PointContext& context, const Tensor& F, std::span<const double> state_old,
                       PiolaTangent& tangent) const;
  Lame lame() const { return lame_constants(material.elastic, Space::Solid); }
};

} // namespace amontons
