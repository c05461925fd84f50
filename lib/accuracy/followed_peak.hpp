// How well a pressure that is linear between the corners of facets can follow the true one where it is largest. Reads
// nodal pressures and the points of a slave surface; knows no solver and no solid.
#pragma once

#include "contact/contact_samples.hpp"
#include "mesh/mesh.hpp"

#include <span>

namespace amontons {

/// What the largest nodal pressure may be off, relative to it and >= 0, because pressure is linear on facets.
///
/// Errors of the stress in the solid do not tell how far a nodal pressure is from the pressure at its node: on cells of
/// order 2 the solid sees the augmented pressure at points, and multipliers that are linear on facets only have to be
/// close to it in the mean. With p twice differentiable, linear functions λ close to p differ from it at nodes by
/// multiples of h² p'': the interpolant by none, the projection in L2 by −h² p''/12 on equal facets of a curve
/// (∫ (x² − λ) φ_i = 0 for λ(x_i) = x_i² − h²/6). Which of them the equilibrium of forces picks depends on the elements
/// and has either sign, so what is estimated is the size of the term: that of the projection. It is found without
/// second derivatives. For f = w q, w a smooth weight with w = 0 beyond two facets, q quadratic,
///   ∫ (p − Πp) f = ∫ (p − Πp) (f − Πf) = O(h⁴),
/// so the quadratic fitted to Πp with the weight w is that fitted to p but for O(h⁴), and at the node it differs from
/// Πp by the deviation wanted. Where the pressure has no second derivative (edges of punches) it is large at any h.
///
/// `nodal`: pressure >= 0 at local mesh nodes, as far as they are corners of `slave`; `samples`: of that surface. Zero
/// where nothing presses. Collective.
double peak_deviation(const Mesh& mesh, const FacetSet& slave, const ContactSamples& samples,
                      std::span<const double> nodal);

} // namespace amontons
