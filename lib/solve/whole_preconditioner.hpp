// Multigrid for SNESVI's reduced systems. The reduced-space method solves for the inactive unknowns only; a matrix with
// some components of some nodes missing has lost its blocks and its rigid-body modes, and PETSc 3.18 cannot set GAMG up
// again when the size has changed. So the preconditioner works on all unknowns, with rows and columns of the active
// ones replaced by the diagonal, and is used between an injection and its transpose.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace amontons {

class WholePreconditioner {
 public:
  /// Takes the place of the SNES's preconditioner, whose type and options it keeps. Collective.
  explicit WholePreconditioner(SNES snes);
  WholePreconditioner(const WholePreconditioner&) = delete;
  WholePreconditioner& operator=(const WholePreconditioner&) = delete;

  /// The near-null space of the whole matrix from now on.
  void take_modes(NullSpaceHandle modes) { modes_ = std::move(modes); }

 private:
  static PetscErrorCode set_up(PC);
  static PetscErrorCode apply(PC, Vec in, Vec out);
  void rebuild();

  SNES snes_; // not owned: it owns the PC that calls us
  std::string type_;
  NullSpaceHandle modes_;
  Handle<PC, PCDestroy> inner_;
  MatHandle matrix_;
  VecHandle in_, out_;
  ScatterHandle scatter_;
};

} // namespace amontons
