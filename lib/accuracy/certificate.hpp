// The certificate of an accepted increment: whether the contact conditions, the balances and the energy bounds really
// hold. It searches the surfaces afresh and shares nothing with the solver but the mesh, its shape functions and
// lib/geometry; it reads what the solver claims as plain data.
#pragma once

#include "contact/contact_samples.hpp"
#include "math/space.hpp"
#include "mesh/mesh.hpp"

#include <span>
#include <string>
#include <vector>

namespace amontons {

/// The largest value of each item that still passes (of volume_ratio: the value that must be exceeded). Dimensionless.
struct CertificateTolerances {
  double penetration = 0.05;     // depth / local facet size
  double tension = 1e-2;         // tensile contact traction / largest pressure
  double complementarity = 1e-2; // Σ |pressure| |gap| / h / total force; and the same for left_master
  double balance = 1e-6;         // force and moment out of balance / force scale
  double energy = 1e-6;          // violation of the energy bounds / energy scale
  double volume_ratio = 0.0;     // smallest det(I + ∇u) / reference volume
  double friction = 1e-6;        // shear off the law's limit, and negative frictional work, relative (see certify)
  double slip = 0.1;             // tangential motion that is not the slip claimed / largest motion (see certify)
  double artificial = 0.05;      // work taken by artificial forces / energy scale
  double supports = 1e-12;       // displacement of a support off the prescribed one / largest displacement
};

/// Energies over all ranks, the same on every rank. All cumulative since the start of the run.
struct EnergyLedger {
  /// Σ potential of all forms: strain energy of the bodies and the potential (σ² − λ²) / (2 ε) of the contact, normal
  /// and tangential.
  double stored = 0.0;
  /// Frictional dissipation, Σ over increments of ∫ shear traction · slip, and what the materials have dissipated.
  double dissipated = 0.0;
  /// Σ ½ (f_old + f) · Δu over supports, loads and moving rigid masters.
  double external_work = 0.0;
  /// What of the external work artificial forces took (stabilization), by the same rule.
  double artificial = 0.0;
  /// Largest |external_work − stored − dissipated − artificial| that the length of the increments explains. With f = K
  /// u + contact forces, K constant (linear elastic bodies), the trapezoidal rule is exact for the bodies, in every
  /// increment
  ///   ½ (f_old + f) · Δu = Δ strain energy + Σ over slave points of ½ (σ_old + σ) Δg + ½ (t_old + t) · Δg_t
  ///   Δf · Δu = 2 · strain energy(Δu) + Σ Δσ Δg + Δt · Δg_t,
  /// σ normal traction, t shear traction, g gap and g_t tangential motion of a point. The contact potential ψ(g, λ) is
  /// convex in g, and where there are multipliers they make it largest, so Σ σ_old Δg <= Δψ <= Σ σ Δg and
  ///   |Σ ½ (σ_old + σ) Δg − Δψ| <= Σ ½ Δσ Δg = ½ Δf · Δu − strain energy(Δu) − Σ ½ Δt · Δg_t.
  /// So it is the sum over increments of ½ Δf · Δu − strain energy(Δu), plus for each pair with friction
  /// |Σ ½ (t_old + t) · Δg_t − t · slip − Δ tangential potential| + Σ ½ |Δt · Δg_t|, and for each curved rigid master
  /// what its turning normal takes (ContactForm::turning_work). But for the last it falls with the increments; the
  /// energy item of the certificate holds what remains beyond it to the tolerance. Where a body is not linear elastic
  /// the first part is Σ ½ |Δf · Δu| over the equations.
  double work_uncertainty = 0.0;
  /// f · u + Σ over slave points of pressure · n · (u_slave − u_master) − ∫ stress : displacement gradient, now: the
  /// principle of virtual work with the displacement itself, zero in equilibrium whatever the material. (P : (F − 1)
  /// per reference volume; for linear elastic bodies twice the strain energy.) And the sum of the absolute values of
  /// the terms.
  double virtual_work_defect = 0.0;
  double virtual_work_scale = 0.0;
};

/// A displacement component of a local node that is prescribed now.
struct SupportedComponent {
  std::int32_t node;
  int component;
  double displacement; // length
};

/// What is certified. Views the caller's data.
struct CertificateInput {
  const Mesh& mesh;
  Space space;
  std::span<const double> displacement;    // num_local x dim, ghosts up to date
  std::span<const double> increment;       // of the displacement since the last accepted state, likewise
  std::span<const ContactPairNames> pairs; // the same on every rank
  std::span<const ContactSamples> samples; // of this rank, one a pair
  /// num_local x dim: this rank's parts of the applied loads and of the support reactions (their sums over ranks
  /// count). The out-of-balance force of a node that is not supported does not belong here: it is what the balance is
  /// to find.
  std::span<const double> external_forces;
  /// Of this rank, from the deck and not from the solver.
  std::span<const SupportedComponent> supports;
  EnergyLedger energy;
  CertificateTolerances tolerances;
  /// Forces and energies below these are rounding (an unloaded scene has nothing else): lower limits of the scales.
  double force_floor = 0.0;
  double energy_floor = 0.0;
  /// Finite: forces act at the deformed places, which moments are taken of.
  Kinematics kinematics = Kinematics::Small;
};

struct Certificate {
  struct Item {
    std::string name;
    double value; // 1e300 stands for not a number or no finite value
    double tolerance;
    bool passed;
    std::string where; // the worst place, in words; may be empty
  };
  /// penetration, tension, complementarity, left_master, force_balance, moment_balance, body_balance, virtual_work,
  /// energy, volume_ratio, missed_contact, friction_cone, slip, dissipation, artificial, supports: always all of them,
  /// in this order.
  std::vector<Item> items;
  bool passed() const;
};

/// left_master: Σ |pressure| times the distance, in facets and at most one, by which a point has come to be beside its
/// master since the search, over the force of the pair. Small kinematics keeps the pairing of the reference
/// configuration, so that a point which has slid off the master's end goes on pressing on it; the reference place moved
/// by u_slave − u_master is where it is now. Zero in finite kinematics, where pressure beyond the master is a matter of
/// complementarity.
/// friction_cone: the pair's law is asked anew for its limit at the pressure and slip claimed; shear beyond it (in
/// slip: off it), shear out of the tangent plane and shear without contact, relative to the pair's largest limit or
/// shear. slip: Σ |shear| |Δg_t − slip| over Σ |shear| times the largest displacement increment in the scene, with
/// Δg_t the tangential motion in this increment that a fresh search finds: what is said to stick must not move and what
/// is said to slip must have moved so. A penalty's elastic slip shows here as its penetration does in `penetration`.
/// dissipation: negative work of shear on slip, relative to Σ |shear| slip.
///
/// Checks everything; the same result on every rank. Throws std::invalid_argument when the input does not fit
/// together. Collective.
Certificate certify(const CertificateInput& input);

} // namespace amontons
