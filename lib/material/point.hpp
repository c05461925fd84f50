// What a bulk law takes and gives at one point: plain numbers. Laws are three-dimensional; plane strain and axisymmetry
// are embedded by whoever calls (strain components zero, or F_33 = 1 and F_33 = r / R). A law knows no element, no mesh
// and no unknown; it keeps nothing: the caller stores the new state when an increment is accepted and drops it
// otherwise.
#pragma once

#include "math/spectral.hpp"

#include <span>

namespace amontons {

/// What a law may know of the increment besides the strain.
struct PointContext {
  /// Duration of the increment, >= 0, unit of time. Each rate-dependent law says what it takes zero for.
  double dt = 0.0;
};

/// How the evaluation of a point ended. All but Solved ask for a smaller increment; stresses are then zero and the new
/// state is the old one, never NaN.
enum class PointOutcome {
  Solved,
  Inverted,     // det F <= 0
  NotFinite,    // the strain, or the stress that belongs to it, is not a finite number
  NotConverged, // the local iteration of the flow rule did not end
};

/// Small strain: σ(ε) with the energies at the end of the increment.
struct SmallResponse {
  Stress<3> stress = Stress<3>::Zero();
  double stored = 0.0;     // recoverable energy per volume, unit of stress
  double dissipated = 0.0; // in this increment, per volume, >= 0
  PointOutcome outcome = PointOutcome::Solved;
};

/// Finite strain: first Piola-Kirchhoff stress P, force per reference area: P(i, J) acts in direction i on the plane
/// with normal J. Energies per reference volume.
struct FiniteResponse {
  Tensor piola = Tensor::Zero();
  double stored = 0.0;
  double dissipated = 0.0;
  PointOutcome outcome = PointOutcome::Solved;
};

/// dP/dF: entry (3 i + J, 3 k + L) = ∂P_iJ / ∂F_kL. Symmetric where P is the derivative of a potential.
using PiolaTangent = Eigen::Matrix<double, 9, 9, Eigen::RowMajor>;

/// F_iJ at 3 i + J, the order of rows and columns of PiolaTangent.
inline Eigen::Matrix<double, 9, 1> flat(const Tensor& F) { return F.transpose().reshaped(); }

/// The inverse of flat.
inline Tensor unflat(const double* f) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(f); }

/// A key of the deck with its reader (deck/rule.hpp); each law declares its own.
template <class T>
struct Rule;

} // namespace amontons
