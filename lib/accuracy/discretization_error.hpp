// How much of the answer is the mesh: the error of the finite elements in the energy norm, estimated from the stress
// itself. Reads strains and stresses of the solid and the status of contact points; knows no solver and no load.
#pragma once

#include "contact/contact_samples.hpp"
#include "form/solid.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// A node of a slave surface around which points differ in status (open, stick, slip).
struct ContactEdgePoint {
  std::array<double, 3> place{}; // X + u
  double size = 0.0;             // mean size of the facets around, length
};

/// The edge points of all pairs, gathered from all ranks. `slaves`: surface of each pair; `samples`: one a pair;
/// `displacement`: num_local x dim. Collective.
std::vector<ContactEdgePoint> contact_edge(const Mesh& mesh, std::span<const double> displacement,
                                           std::span<const std::string> slaves,
                                           std::span<const ContactSamples> samples);

/// Energy norms are sqrt(∫ Δσ : Δε), in the root of a work.
struct DiscretizationError {
  double error = 0.0;     // of the stress: recovered against computed
  double near_edge = 0.0; // the part of `error` in cells within a facet of the edge of contact; squares add up
  double solution = 0.0;  // sqrt(∫ σ : ε) of the computed field

  /// Error over the norm of the exact solution, of which solution² + error² is the estimate: 0 to 1.
  double relative() const;
  /// Part of the squared error that comes from near the edge of contact: 0 to 1.
  double edge_share() const;
};

/// Zienkiewicz and Zhu's estimate by superconvergent patch recovery (IJNME 33, 1992): around every corner node a
/// polynomial of the element's order p is fitted to stresses and strains of the cells there, at the places where they
/// are best; between the corners the polynomials are blended by the functions of order 1 (Blacker and Belytschko, IJNME
/// 37, 1994). What it differs from the computed field is of the size of the error, which is of order p, and tends to it
/// where the solution is smooth. Patches never reach across contact or from one body to another. At edges of contact
/// and corners, where derivatives are not bounded, it tells where the error is, but only roughly how large.
/// Of solids that are not linear elastic it is the error of (Cauchy's) stress in L2, ∫ Δσ : Δσ / E over the reference
/// volume; for them the order of the best points is not proven, so there it is an indicator rather than an estimate.
/// Zero where the exact stress is a polynomial of order p that the elements reproduce. Collective.
DiscretizationError estimate_discretization_error(SolidForm& solid, const Mesh& mesh, const State& state,
                                                  std::span<const ContactEdgePoint> edge);

} // namespace amontons
