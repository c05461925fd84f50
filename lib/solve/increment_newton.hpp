// What a Newton method for one increment is to the ladder of remedies, whatever its unknowns are: it solves, shortens
// its steps on demand, and shows the points whose branches it switches between.
#pragma once

#include "form/switching.hpp"
#include "solve/status_watch.hpp"

#include <petscvec.h>
#include <string>
#include <variant>
#include <vector>

namespace amontons {

/// How a solve went. Not converging is an outcome, not an exception.
struct SolveOutcome {
  bool converged = false;
  int newton = 0;         // iterations
  int linear = 0;         // Krylov iterations (1 a solve with a direct solver)
  int outer = 0;          // Uzawa iterations, 0 without multipliers to update
  int factorizations = 0; // or preconditioner set-ups
  double residual = 0.0;  // out-of-balance force relative to the force scale
  std::string reason;     // in words
  bool interrupted = false;
  int rung = 0; // of the ladder of remedies that it took, counted from 1; 0: none
  /// Adds the effort of another solve.
  void add_effort(const SolveOutcome& other);
};

/// How long steps are: as chosen by the options, or shortened until a merit function falls, the one that suits the
/// problem.
struct ChosenSteps {};
struct MeritSteps {};
using StepLength = std::variant<ChosenSteps, MeritSteps>;

class IncrementNewton {
 public:
  IncrementNewton() = default;
  IncrementNewton(const IncrementNewton&) = delete;
  IncrementNewton& operator=(const IncrementNewton&) = delete;
  virtual ~IncrementNewton() = default;

  /// From the state in `unknowns` (prescribed values already in place) to equilibrium. Collective.
  virtual SolveOutcome solve(Vec unknowns) = 0;
  /// For the next solves.
  virtual void set_steps(const StepLength& steps) = 0;
  /// Residual of the equations that solve() makes zero, relative to the forces in play; evaluates the branches there.
  /// Collective.
  virtual double imbalance(Vec unknowns) = 0;
  /// What its points belong to, to be held; the watch has them in the same order.
  virtual std::vector<Switching*> switching() const = 0;
  /// Of the last solve.
  virtual const StatusWatch& watch() const = 0;
};

} // namespace amontons
