#include "increment_solver.hpp"

#include "solve/solver_choice.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// One loop updates the multipliers of all pairs: the strictest of their settings hold.
std::unique_ptr<UzawaLoop> make_uzawa(Scene& scene, Newton& newton) {
  if (!scene.multipliers) return nullptr;
  double tolerance = 1.0;
  int iterations = 0;
  for (const auto& pair : scene.deck.contact)
    if (const auto* uzawa = std::get_if<UzawaDeck>(&pair.enforce)) {
      tolerance = std::min(tolerance, uzawa->tolerance);
      iterations = std::max(iterations, uzawa->max_iterations);
    }
  return std::make_unique<UzawaLoop>(*scene.problem, newton, *scene.multipliers, tolerance, iterations);
}

/// For multipliers that another solve starts from: change of an update, relative, and how many there may be.
constexpr double good_start = 1e-3;
constexpr int most_updates = 30;
/// The alpha with which ε is as stiff as the bodies: Uzawa's loop needs no more, and its solves are the harder the more
/// it is.
constexpr double own_stiffness = 1.0;

bool is_unknown(const ContactForm* pair) { return std::holds_alternative<Semismooth>(pair->pair().enforcement); }

VecHandle copy_of(Vec vec) {
  VecHandle copy;
  AMT_PETSC(VecDuplicate(vec, copy.put()));
  AMT_PETSC(VecCopy(vec, copy));
  return copy;
}

} // namespace

IncrementSolver::IncrementSolver(Scene& scene, std::function<bool()> interrupted,
                                 std::function<void(const std::string&)> tell)
    : scene_(scene), tell_(std::move(tell)), unknowns_(scene.layout->new_vector()),
      accepted_(scene.layout->new_vector()) {
  forget_default_options(); // of a mesh before this one
  if (scene.bounds) {
    linear_solver_ = choose_bounded_solver(*scene.problem);
    bounded_ = std::make_unique<BoundedNewton>(*scene.problem, *scene.bounds, std::move(interrupted));
    return;
  }
  chosen_rungs(); // a wrong name is found before anything is solved
  if (scene.conditions) {
    linear_solver_ = choose_linear_solver(*scene.problem);
    condensed_ = std::make_unique<CondensedNewton>(*scene.problem, *scene.conditions, std::move(interrupted));
    return;
  }
  // Full Newton steps go in circles where points switch between elastic and plastic.
  if (scene.bulk->wants_predictor()) default_option("-snes_linesearch_type", SNESLINESEARCHBT);
  linear_solver_ = choose_newton_solver(*scene.problem);
  newton_ = std::make_unique<Newton>(*scene.problem, std::move(interrupted));
  uzawa_ = make_uzawa(scene, *newton_);
}

/// Where supports move, moves all unknowns on as they moved last: plastic flow that localizes is far from what the
/// elastic tangent at the start of an increment says. The supports are put right by Problem::begin_increment and its
/// predictor. (Not where loads drive: nearly incompressible bodies are further from equilibrium on a straight way on
/// than where they were.)
void IncrementSolver::extrapolate(double target) {
  if (!rate_ || !scene_.problem->wants_prediction()) return;
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  AMT_PETSC(VecAXPY(unknowns_, target - scene_.problem->accepted_time(), rate_));
  scene_.problem->begin_increment(target, unknowns_);
}

void IncrementSolver::start(double target) {
  target_ = target;
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  scene_.problem->begin_increment(target, unknowns_);
  extrapolate(target);
}

SolveOutcome IncrementSolver::solve_plainly() {
  if (bounded_) return bounded_->solve(unknowns_);
  if (condensed_) return condensed_->solve(unknowns_);
  return uzawa_ ? uzawa_->solve(unknowns_) : newton_->solve(unknowns_);
}

SolveOutcome IncrementSolver::solve(double target) {
  start(target);
  auto outcome = solve_plainly();
  if (outcome.converged || outcome.interrupted) return outcome;
  trouble_ = bounded_ ? bounded_->trouble() : condensed_ ? condensed_->trouble() : newton_->trouble();
  trouble_->solver = outcome.reason;
  outcome.reason = in_words(*trouble_);
  if (bounded_) return outcome;
  if (!ladder_) ladder_ = make_ladder();
  return ladder_->climb(unknowns_, outcome, *trouble_);
}

bool IncrementSolver::solve_linearized(Vec load, double accuracy, Vec result) {
  return newton_ && newton_->solve_linearized(accepted_, load, accuracy, result);
}

SolveOutcome IncrementSolver::solve_from(const OtherStart& from, double target) {
  roll_back();
  start(target);
  if (scene_.multipliers) { // those of the last state would lead back to it
    const auto none = scene_.multipliers->new_vector();
    AMT_PETSC(VecSet(none, 0.0));
    scene_.multipliers->set(none);
  }
  const auto gone = go_to(from, *scene_.problem, *newton_, unknowns_);
  if (!gone.converged) return gone;
  auto outcome = solve_plainly();
  outcome.add_effort(gone);
  return outcome;
}

/// With the multipliers of all pairs in one loop, whether unknown or not.
SolveOutcome IncrementSolver::loop_on_multipliers() {
  UzawaMultipliers held(scene_.mesh, scene_.with_multipliers);
  for (auto* pair : scene_.with_multipliers)
    pair->scale_augmentation(std::min(1.0, own_stiffness / pair->pair().alpha));
  UzawaLoop loop(*scene_.problem, *newton_, held, good_start, most_updates);
  auto outcome = loop.solve(unknowns_);
  outcome.converged = loop.is_balanced();
  for (auto* pair : scene_.with_multipliers) {
    pair->release_multipliers();
    pair->scale_augmentation(1.0);
  }
  return outcome;
}

std::unique_ptr<Ladder> IncrementSolver::make_ladder() {
  const auto restart = [this] {
    roll_back();
    start(target_);
  };
  const auto make_support = [this](double ratio) -> std::unique_ptr<Form> {
    auto& problem = *scene_.problem;
    auto support = std::make_unique<ViscousForm>(*scene_.layout, scene_.deck.space, scene_.stiffness(), ratio,
                                                 target_ - problem.accepted_time());
    auto state = problem.state_at(accepted_);
    state.time = problem.accepted_time();
    support->commit(state);
    return support;
  };
  const auto& pairs = scene_.with_multipliers;
  std::function<SolveOutcome()> loop;
  if (std::any_of(pairs.begin(), pairs.end(), is_unknown)) loop = [this] { return loop_on_multipliers(); };
  IncrementNewton& newton = condensed_ ? static_cast<IncrementNewton&>(*condensed_) : *newton_;
  return std::make_unique<Ladder>(*scene_.problem, newton,
                                  Ladder::Hooks{.restart = restart,
                                                .solve = [this] { return solve_plainly(); },
                                                .loop = loop,
                                                .make_support = make_support,
                                                .tell = tell_});
}

void IncrementSolver::commit() {
  if (ladder_) ladder_->release_rungs();
  const double duration = scene_.problem->time() - scene_.problem->accepted_time();
  scene_.problem->commit(unknowns_);
  if (scene_.bulk->wants_predictor()) {
    VecHandle step = copy_of(unknowns_);
    AMT_PETSC(VecAXPY(step, -1.0, accepted_));
    AMT_PETSC(VecScale(step, 1.0 / duration));
    const auto rate = scene_.problem->state_at(step).displacement;
    rate_ = scene_.layout->new_vector(); // without multipliers
    scene_.layout->put_displacement(rate, rate_);
  }
  resume();
}

void IncrementSolver::roll_back() {
  rate_.reset();
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  scene_.problem->roll_back();
}

void IncrementSolver::resume() { AMT_PETSC(VecCopy(unknowns_, accepted_)); }

void IncrementSolver::save(Checkpoint& checkpoint) const {
  if (!rate_) return;
  NodalArray rate{scene_.mesh.dim, std::vector<double>(std::size_t(scene_.mesh.num_local()) * scene_.mesh.dim)};
  scene_.layout->gather_displacement(rate_, rate.values);
  checkpoint.nodal["displacement_rate"] = std::move(rate);
}

void IncrementSolver::restore(const Checkpoint& checkpoint) {
  const auto stored = checkpoint.nodal.find("displacement_rate");
  if (stored == checkpoint.nodal.end()) return;
  rate_ = scene_.layout->new_vector();
  scene_.layout->put_displacement(stored->second.values, rate_);
}

SolvedState IncrementSolver::put_aside(const SolveOutcome& outcome) {
  const auto state = scene_.problem->state_at(unknowns_);
  SolvedState solved{.time = state.time,
                     .outcome = outcome,
                     .unknowns = copy_of(unknowns_),
                     .multipliers = {},
                     .forces_on_bounds = {},
                     .displacement = {state.displacement.begin(), state.displacement.end()},
                     .samples = {}};
  if (scene_.multipliers) {
    solved.multipliers = scene_.multipliers->new_vector();
    scene_.multipliers->get(solved.multipliers);
  }
  for (auto* contact : scene_.contacts) {
    if (bounded_) solved.forces_on_bounds.push_back(contact->multipliers());
    solved.samples.push_back(contact->samples(state));
  }
  return solved;
}

std::vector<SolvedState> IncrementSolver::solve_halves(double target, SolveOutcome& outcome) {
  const auto start = scene_.problem->snapshot();
  const auto before = copy_of(accepted_);
  std::vector<SolvedState> halves;
  outcome = {};
  for (const double end : {0.5 * (start.time + target), target}) {
    const auto half = solve(end);
    outcome.add_effort(half);
    outcome.reason = half.reason;
    outcome.converged = half.converged;
    if (!half.converged) break;
    halves.push_back(put_aside(half));
    commit();
  }
  scene_.problem->restore(start);
  AMT_PETSC(VecCopy(before, accepted_));
  roll_back();
  return halves;
}

void IncrementSolver::revisit(const SolvedState& state) {
  AMT_PETSC(VecCopy(state.unknowns, unknowns_));
  if (scene_.multipliers) scene_.multipliers->set(state.multipliers);
  for (std::size_t i = 0; i < state.forces_on_bounds.size(); ++i)
    scene_.contacts[i]->hold_multipliers(state.forces_on_bounds[i]);
  scene_.problem->revisit(state.time, unknowns_);
  if (condensed_) condensed_->recover(unknowns_);
}

void IncrementSolver::end() {
  ladder_.reset();
  uzawa_.reset();
  newton_.reset();
  condensed_.reset();
  bounded_.reset();
}

} // namespace amontons
