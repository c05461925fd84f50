// What a bulk law offers to the forms: stresses, energies and moduli for a batch of points, as plain arrays. A law
// belongs to one material in one space; it knows nothing of meshes, elements or unknowns.
#pragma once

#include "math/space.hpp"

#include <memory>
#include <optional>
#include <span>

namespace amontons {

/// σ = λ tr(ε) 1 + 2 G ε over the in-plane components (all three in axisymmetric and solid space). Same unit as stress.
struct Lame {
  double lambda;
  double G;
};

/// Small-strain law. Arrays run point by point with strain_size components each (order of math/tensor.hpp): 4 in the
/// plane spaces and axisymmetry, 6 in solid space. Strains are dimensionless, stresses in the unit of the moduli.
/// One virtual call serves a batch of points.
class BulkLaw {
 public:
  BulkLaw() = default;
  BulkLaw(const BulkLaw&) = delete;
  BulkLaw& operator=(const BulkLaw&) = delete;
  virtual ~BulkLaw() = default;

  virtual void stress(std::span<const double> strain, std::span<double> stress) const = 0;
  /// Strain energy per volume, one number a point.
  virtual void energy(std::span<const double> strain, std::span<double> density) const = 0;
  /// dσ/dε, strain_size x strain_size numbers a point (symmetric).
  virtual void moduli(std::span<const double> strain, std::span<double> moduli) const = 0;

  /// The constants when the moduli are isotropic and never change: forms then take a much faster kernel.
  virtual std::optional<Lame> constant_lame() const { return std::nullopt; }
  /// Young's modulus or what comes closest, for scales (penalty factors, condition estimates).
  virtual double stiffness() const = 0;
  /// Sets the zz strain that the in-plane strains imply where zz is free (plane stress); for output.
  virtual void complete_strain(std::span<double>) const {}
};

using BulkLawPtr = std::shared_ptr<const BulkLaw>;

} // namespace amontons
