// Elastoplasticity after von Mises at small strain.
#pragma once

#include "material/elastic_plastic.hpp"
#include "material/point.hpp"

#include <array>
#include <string_view>

namespace amontons {

/// σ = K tr(ε) 1 + 2 G dev(ε − ε_p), flow by radial_return. Symmetric tangent.
/// State: p, then ε_p with engineering shears in the order of math/tensor.hpp; all zero at the start. The backstress is
/// 2/3 H ε_p and needs no room.
struct SmallPlastic {
  ElasticPlastic material;
  static constexpr std::array<std::string_view, 7> state_names{
      "accumulated_plastic_strain", "plastic_strain_xx", "plastic_strain_yy", "plastic_strain_zz",
      "plastic_strain_xy",          "plastic_strain_yz", "plastic_strain_zx"};

  SmallResponse respond(const PointContext& context, const Strain<3>& strain, std::span<const double> state_old,
                        std::span<double> state_new) const;
  /// dσ/dε with engineering shears, at the end of the increment.
  PointOutcome tangent(const PointContext& context, const Strain<3>& strain, std::span<const double> state_old,
                       Moduli<3>& moduli) const;
};

} // namespace amontons
