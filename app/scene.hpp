// A deck turned into a Problem: the one place that knows every part. Nothing is constructed that the deck does not ask
// for.
#pragma once

#include "contact/condensed_contact.hpp"
#include "contact/mortar_transform.hpp"
#include "contact/uzawa_multipliers.hpp"
#include "deck.hpp"
#include "form/follower_pressure.hpp"
#include "form/loads.hpp"
#include "form/problem.hpp"
#include "form/solid.hpp"
#include "form/viscous.hpp"
#include "mesh/build.hpp"

#include <memory>
#include <string>
#include <vector>

namespace amontons {

/// Everything that a run computes with. Lives on the heap and does not move: its parts refer to each other.
struct Scene {
  Deck deck;
  Mesh mesh;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  SolidForm* bulk = nullptr;                     // owned by the problem
  LoadForm* loads = nullptr;                     // absent without loads that keep their direction
  FollowerPressureForm* follower = nullptr;      // absent without pressures in finite kinematics
  ViscousForm* stabilization = nullptr;          // absent without stabilization
  std::vector<PairReport*> contacts;             // owned by the problem
  std::vector<ContactForm*> with_multipliers;    // of them: `uzawa`, and `semismooth` with the nodal basis
  std::unique_ptr<UzawaMultipliers> multipliers; // absent without `uzawa` pairs
  std::unique_ptr<MortarTransform> bounds;       // absent without `vi` pairs
  std::unique_ptr<CondensedContact> conditions;  // absent without `semismooth` pairs with the dual basis
  std::vector<std::string> floating;             // bodies held by contact alone

  /// Young's modulus by body.
  std::vector<double> stiffness() const;
  /// Energy stored in all bodies. Collective.
  double bulk_energy(Vec unknowns) const;
  /// Energy that their materials have dissipated since the start. Collective.
  double bulk_dissipation(Vec unknowns) const;
  /// SolidForm::internal_work of all bodies. Collective.
  double internal_work(Vec unknowns) const;
};

/// Reads the mesh of a deck, checks the one against the other, distributes and sets up. Throws UserError with
/// everything that is wrong, on every rank. `meshing` counts where the deck has `adapt`. Collective.
std::unique_ptr<Scene> build_scene(MPI_Comm comm, Deck checked, const FreeMeshing& meshing = {});

/// The pairs as the deck declares them, with rigid masters where they are now: for reports and the certificate.
std::vector<ContactPairNames> pair_names(const Scene& scene);

} // namespace amontons
