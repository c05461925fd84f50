// The single checks of the certificate, each returning its worst value over all ranks. For lib/accuracy only.
#pragma once

#include "accuracy/certificate.hpp"
#include "accuracy/worst.hpp"

namespace amontons::accuracy {

/// Gaps of the pairs: penetration relative to the facet size; relative to the force of the pair Σ |p g| / h, and Σ |p|
/// times the distance, in facets and at most one, by which a point has come to be beside the master.
struct GapChecks {
  Worst penetration;
  Worst complementarity;
  Worst left_master;
};

/// Contact forces as the samples claim them, on each body: from the slave side, and through the fresh search on the
/// master side. Rows of `on_body`: force and moment about `pivot`. This rank's part.
struct ClaimedForces {
  std::vector<std::array<double, 6>> on_body;
  std::array<double, 6> by_rigid{}; // sum over the pairs with a rigid master: an outer force
  std::array<double, 6> couple{};   // of the shear on slave and master, which lie apart before they touch
  double absolute = 0.0;            // Σ |traction| w
};

/// Searches every pair afresh; fills in the forces. Collective.
GapChecks check_gaps(const CertificateInput& input, const std::array<double, 3>& pivot, ClaimedForces& forces);

/// Largest tensile traction, at points or nodes, relative to the largest pressure of the pair. Collective.
Worst check_tension(const CertificateInput& input);

/// Sums of forces and moments of the whole scene, and of each body (or set of bodies that share nodes) with the claimed
/// contact forces.
struct BalanceChecks {
  Worst force, moment, body;
};
/// `size`: diameter of the scene. Collective.
BalanceChecks check_balance(const CertificateInput& input, const std::array<double, 3>& pivot, double size,
                            const ClaimedForces& forces);

/// Minus the smallest volume ratio. Collective.
Worst check_volume(const CertificateInput& input);

/// Largest distance of a supported component from where its support puts it, relative to the largest displacement of
/// the scene. Collective.
Worst check_supports(const CertificateInput& input);

/// Deepest node of a body inside another body or a rigid shape in the current configuration, relative to the facet
/// size. Collective.
Worst check_overlap(const CertificateInput& input);

/// What the frictional pairs claim; zero without friction (see certify).
struct FrictionChecks {
  Worst cone, slip, dissipation;
};
/// Collective.
FrictionChecks check_friction(const CertificateInput& input);

/// Adds f and (x − pivot) × f.
void add_wrench(std::array<double, 6>& sum, const std::array<double, 3>& x, const std::array<double, 3>& pivot,
                const std::array<double, 3>& f);

} // namespace amontons::accuracy
