// How much two solutions of the same increment differ that was taken in one and in two pieces: what the answer owes to
// the size of the increments. Compares plain data of two states; knows neither how they were solved nor what follows.
#pragma once

#include "contact/contact_samples.hpp"

#include <mpi.h>
#include <span>
#include <vector>

namespace amontons {

/// A state as it is compared: displacement of this rank's nodes (num_local x dim), and samples, one a pair.
struct PathState {
  int dim;
  std::span<const double> displacement;
  std::span<const ContactSamples> samples;
};

/// What differences are small against. The largest of all states that have been computed in a run: where contact begins
/// or a load turns, the state's own size would be too small a measure, and no increment small enough.
struct PathScales {
  double displacement = 0.0; // largest |u| of a node, length
  struct Pair {
    double pressure = 0.0; // sqrt ∫ p² over the slave surface
    double shear = 0.0;    // sqrt ∫ τ_c²: the shear that the law allows, whether it is reached or not
    double traction = 0.0; // largest |traction| of a point
    double area = 0.0;     // in contact
  };
  std::vector<Pair> pairs;

  /// Takes the larger of each.
  void include(const PathScales& other);
};

/// Collective.
PathScales path_scales(MPI_Comm comm, const PathState& state);

/// All relative to the scales; of the pairs the largest.
struct PathDifference {
  double displacement = 0.0; // largest |u_a − u_b| of a node
  double pressure = 0.0;     // sqrt ∫ (p_a − p_b)²
  double shear = 0.0;        // sqrt ∫ |σ_t,a − σ_t,b|², of the vectors; zero without friction
  /// Area of the points that are open, stick or slide in one state and not in the other, and whose tractions differ,
  /// too, by more than a hundredth of the pair's largest: a point on the border falls on either side.
  double status = 0.0;

  /// Of displacement and tractions.
  double largest() const;
};

/// Both states have the same points. The same on every rank. Collective.
PathDifference path_difference(MPI_Comm comm, const PathState& a, const PathState& b, const PathScales& scales);

} // namespace amontons
