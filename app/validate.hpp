// What a deck asks of its mesh, and the way from a deck to its checked mesh that both `check` and a run take.
#pragma once

#include "deck.hpp"
#include "mesh/build.hpp"

namespace amontons {

/// The mesh that the deck names, with the path of its file as seen from the working directory; `meshing` counts where
/// the deck has `adapt`.
MeshSource mesh_source(const Deck& deck, const FreeMeshing& meshing = {});

/// The pairs of mesh surfaces that the deck declares to be in contact.
ContactHints contact_hints(const Deck& deck);

/// Throws UserError with everything in the deck that does not fit the mesh, each with its place in the deck: groups and
/// bodies that do not exist or have the wrong dimension, bodies without material, slave and master with common facets,
/// conditions that contradict each other at shared nodes, loaded or contact surfaces inside a body ... Serial: call
/// where `raw` is.
void validate_against_mesh(const Deck& deck, const RawMesh& raw);

/// The mesh of a deck, read and checked against it, on rank 0; empty elsewhere. Nothing is written. Throws UserError on
/// every rank. Collective.
RawMesh read_checked_mesh(MPI_Comm comm, const Deck& deck, const FreeMeshing& meshing = {});

} // namespace amontons
