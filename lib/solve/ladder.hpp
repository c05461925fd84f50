// The ladder of remedies for an increment that did not converge: fixed rungs in a fixed order, each another way to a
// solution. The last solve of every rung is that of the true equations, so what a rung accepts is what plain Newton
// would have had to find: nothing of a hold, a held limit, a softer augmentation or a support is left in it. What
// follows above the last rung, smaller increments and giving up, is for the caller. Nothing random; a run without
// trouble never comes here.
#pragma once

#include "form/problem.hpp"
#include "solve/increment_newton.hpp"
#include "solve/trouble.hpp"

#include <array>
#include <functional>
#include <memory>
#include <set>
#include <variant>
#include <vector>

namespace amontons {

/// Steps are shortened until a merit function falls (Newton::set_steps).
struct MeritSearch {};
/// Points that went on and off in turn are held as they were at the start; one at a time is let go over to what the
/// state wants, the first by its place: least-index pivoting, which for linear complementarity with a P-matrix cannot
/// go round in circles (K. G. Murty, Linear Algebra Appl. 9 (1974) 161-171).
struct HeldPoints {};
/// Friction with the bound of the last solve, until that changes no more: each solve is one of given friction, whose
/// tangent is symmetric where the law does not depend on more (P. D. Panagiotopoulos, Ing.-Arch. 44 (1975) 421-432).
struct LaggedLimits {};
/// The augmentation is a thousandth, a hundredth and a tenth of what it is by the deck, each solution being the next
/// guess.
struct SofterAugmentation {};
/// Multipliers that are unknowns are held and updated by Uzawa's loop, whose solves are those of the displacements
/// alone.
struct LoopOnMultipliers {};
/// Bodies are supported against moving from the last accepted state, ever less: by ratios (see ViscousForm) from 1 to
/// 1e-6, then not at all.
struct VanishingSupport {};

using Remedy =
    std::variant<MeritSearch, HeldPoints, LaggedLimits, SofterAugmentation, LoopOnMultipliers, VanishingSupport>;

/// The rungs, in their order.
const std::array<Remedy, std::variant_size_v<Remedy>>& remedies();
/// Its key in the summary.
const char* name_of(const Remedy& remedy);

/// Which rungs the option -remedies names (comma-separated keys; `none`), by their place; all without it. Throws
/// UserError, the same on every rank, for a name that there is not.
std::set<std::size_t> chosen_rungs();

class Ladder {
 public:
  struct Hooks {
    /// Puts unknowns and forms to the start of the increment.
    std::function<void()> restart;
    /// Solves the true equations from the unknowns: Newton, or a loop around it.
    std::function<SolveOutcome()> solve;
    /// Holds the multipliers that are unknowns, updates them by Uzawa's loop until a solve can start from there or
    /// often enough, and makes them unknown again. Converged when the last state is in equilibrium with them. Absent
    /// where none are.
    std::function<SolveOutcome()> loop;
    /// A support by ViscousForm of the ratio, meant for an increment of the length dt from the last accepted state.
    std::function<std::unique_ptr<Form>(double ratio)> make_support;
    /// Told of every rung tried and how it went.
    std::function<void(const std::string&)> tell;
  };
  Ladder(Problem& problem, IncrementNewton& newton, Hooks hooks);

  /// Tries the rungs that apply, until one converges or none is left, after a solve that failed with this outcome.
  /// A rung that fails is not tried again until release_rungs(). The outcome has the effort of all, and of a failure
  /// the reason of the first solve. Collective.
  SolveOutcome climb(Vec unknowns, const SolveOutcome& failed, const Trouble& trouble);
  /// One rung by itself, from the start of the increment, after a solve that failed. Collective.
  SolveOutcome attempt(const Remedy& remedy, Vec unknowns);
  /// After an accepted increment: every rung may be tried again.
  void release_rungs() { spent_.clear(); }

  struct Use {
    int tried = 0, helped = 0;
  };
  /// One for each of remedies().
  const std::vector<Use>& uses() const { return uses_; }

 private:
  using Marks = std::vector<std::vector<std::uint8_t>>; // [form][point of this rank]

  void note_flipping();
  SolveOutcome start_over(const Remedy& remedy, Vec unknowns);
  bool applies(const Remedy& remedy, const Trouble& trouble) const;
  SolveOutcome use(MeritSearch, Vec unknowns);
  SolveOutcome use(HeldPoints, Vec unknowns);
  SolveOutcome use(LaggedLimits, Vec unknowns);
  SolveOutcome use(SofterAugmentation, Vec unknowns);
  SolveOutcome use(LoopOnMultipliers, Vec unknowns);
  SolveOutcome use(VanishingSupport, Vec unknowns);
  SolveOutcome pivot(Vec unknowns);

  Problem& problem_;
  IncrementNewton& newton_;
  Hooks hooks_;
  std::vector<Switching*> forms_;
  Marks on_and_off_; // of the solve that failed
  std::set<std::size_t> chosen_, spent_;
  std::vector<Use> uses_;
};

} // namespace amontons
