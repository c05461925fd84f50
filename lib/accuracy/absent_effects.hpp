// What effects would have done that a run leaves out: plasticity, friction, inertia. Each as the size of a term over
// that of the terms that are there. Sums and largest values only; whether they are too large is for others to judge.
#pragma once

#include "contact/contact_samples.hpp"
#include "form/solid.hpp"

#include <span>
#include <vector>

namespace amontons {

/// Of the bodies with a yield stress; `stresses` as in Mesh::bodies, zero where none is known.
struct YieldAudit {
  double ratio = 0.0;     // largest von Mises stress over the yield stress, over all points
  std::int32_t body = -1; // where; -1: no body has stress
};

/// Collective.
YieldAudit audit_yield(SolidForm& solid, const Mesh& mesh, const State& state, std::span<const double> stresses);

/// Volume of each body (area x thickness 1 in the plane, the full turn in axisymmetric space). Collective.
std::vector<double> body_volumes(SolidForm& solid, const Mesh& mesh, const State& state);

/// ∫ p |u_t| over the slave surface, u_t the tangential part of the displacement of the slave over the master since the
/// start, searched anew: the work of a shear traction p on that motion, so what friction of coefficient 1 would at most
/// take if nothing else changed. Counts only what is in contact. A work. Collective.
double sliding_work(const Mesh& mesh, std::span<const double> displacement, const ContactPairNames& pair,
                    const ContactSamples& samples);

/// Motion of an increment: u - u_old over dt.
struct MotionAudit {
  double kinetic = 0.0;       // energy, by the velocity at the middle of each cell
  double largest_speed = 0.0; // largest over bodies of |mean velocity| over the speed of elastic waves
};

/// `increment`: displacement, num_local x dim; `density`, `wave_speed` as in Mesh::bodies, density zero where not known
/// (such bodies do not count). Collective.
MotionAudit audit_motion(const Mesh& mesh, Space space, std::span<const double> increment, double dt,
                         std::span<const double> density, std::span<const double> wave_speed);

} // namespace amontons
