#include "run.hpp"

#include "adaptation.hpp"
#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/log.hpp"
#include "base/timer.hpp"
#include "certify.hpp"
#include "effects_audit.hpp"
#include "error_budget.hpp"
#include "increment_solver.hpp"
#include "ledger.hpp"
#include "output/history.hpp"
#include "output/results_directory.hpp"
#include "output/summary.hpp"
#include "path_record.hpp"
#include "report.hpp"
#include "restart.hpp"
#include "scene.hpp"
#include "solution_census.hpp"
#include "solve/path_control.hpp"
#include "solve/step_control.hpp"
#include "wall_clock.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

constexpr int status_certified = 0, status_not_converged = 3, status_not_certified = 4, status_interrupted = 5;

/// One run: owns the solver and the writers, marches through the steps.
class Run {
 public:
  /// `adaptation`: the passes that this run is one of; null without adaptive meshing.
  Run(MPI_Comm comm, const RunArguments& arguments, const Deck& deck, Adaptation* adaptation);
  std::int64_t num_unknowns() const;
  int march();

 private:
  void open_results();
  void restart();
  StepPlan plan(std::size_t step) const;
  /// A step in progress.
  struct Stretch {
    std::size_t step;
    StepControl control;
    std::optional<PathControl> path;
    const std::string& name;
  };
  Stretch begin_step(std::size_t step);
  // These return an exit status: status_certified to go on.
  int march_step(std::size_t step);
  int stop(const Stretch& stretch);
  int cut_back(Stretch& stretch, double target, const std::string& reason);
  void give_up(const Stretch& stretch, double target, const std::string& reason);
  int accept_whole(Stretch& stretch, const SolveOutcome& outcome);
  int compare_halves(Stretch& stretch, const SolveOutcome& outcome, double seconds);
  int control_path(Stretch& stretch, const SolvedState& whole, const std::vector<SolvedState>& halves, double seconds);
  PathDifference difference(const SolvedState& whole, const std::vector<SolvedState>& halves);
  bool is_cutback_asked_for();
  void count(const SolveOutcome& outcome);
  void accept(const Stretch& stretch, const SolveOutcome& outcome, double path_error);
  void write_checkpoint_file(const Stretch& stretch);
  void progress(const std::string& step, const IncrementReport& report, const std::vector<ContactTotals>& totals);
  void judge_accuracy(int status, nlohmann::ordered_json& summary);
  void close_pass(const DiscretizationError& mesh_error, const FigureErrors& figures, nlohmann::ordered_json& summary);
  int finish(int status, const std::string& reason);
  std::string file(const char* name) const { return directory_ + "/" + name; }

  MPI_Comm comm_;
  RunArguments arguments_;
  Adaptation* adaptation_;
  InterruptScope interrupt_;
  double started_ = now();
  double all_started_; // the first pass of adaptive meshing; without it the same
  Log log_;
  std::unique_ptr<Scene> scene_;
  std::string directory_;
  std::unique_ptr<IncrementSolver> solver_;
  std::unique_ptr<Ledger> ledger_;
  std::unique_ptr<FieldsWriter> fields_;
  std::unique_ptr<HistoryWriter> history_;
  std::optional<SolutionCensus> census_; // absent unless the deck asks for it
  std::optional<PathRecord> path_;       // absent unless the deck asks for the path error
  std::size_t first_step_ = 0;
  std::optional<double> resume_time_;
  double first_time_ = 0.0, resume_increment_ = 0.0, resume_path_taken_ = 0.0;
  bool stop_requested_ = false;
  // Counts for the summary.
  int increments_ = 0, cutbacks_ = 0, newton_iterations_ = 0, linear_iterations_ = 0, outer_iterations_ = 0,
      factorizations_ = 0;
  nlohmann::ordered_json diagnosis_; // of a run that gave up
  CertificateRecord certificate_;
  std::optional<MotionRecord> motion_; // absent unless a material has a density
  double largest_residual_ = 0.0;      // of the accepted increments
  std::vector<ContactTotals> last_totals_;
  std::optional<std::vector<ContactSamples>> last_samples_; // absent until an increment is accepted
};

Run::Run(MPI_Comm comm, const RunArguments& arguments, const Deck& deck, Adaptation* adaptation)
    : comm_(comm), arguments_(arguments), adaptation_(adaptation),
      all_started_(adaptation ? adaptation->started() : started_), log_(comm) {
  scene_ = build_scene(comm, deck, adaptation ? adaptation->meshing() : FreeMeshing{});
  for (const auto& [name, value] : scene_->deck.petsc)
    set_if_absent("-" + name, value);
  directory_ = arguments.out.value_or(scene_->deck.output.directory);
  ledger_ = std::make_unique<Ledger>(*scene_);
  solver_ = std::make_unique<IncrementSolver>(
      *scene_, [this] { return stop_requested_ = interrupted(comm_); },
      [this](const std::string& line) { log_.line("  " + line); });
  if (measures_path(scene_->deck)) path_.emplace();
  if (scene_->deck.look_for_other_solutions) census_.emplace();
  if (MotionRecord::wanted(scene_->deck)) motion_.emplace();
  if (arguments_.restart) restart();
}

std::int64_t Run::num_unknowns() const {
  return scene_->mesh.num_global * scene_->mesh.dim + scene_->layout->num_extra();
}

void Run::restart() {
  const auto checkpoint = read_checkpoint(scene_->mesh, *arguments_.restart, run_identity(*scene_));
  // By time and not by number: the deck may have got more or longer steps since.
  const auto& steps = scene_->deck.steps;
  while (first_step_ < steps.size() && steps[first_step_].to <= checkpoint.time * (1.0 + 1e-12))
    ++first_step_;
  first_time_ = checkpoint.time;
  resume_increment_ = checkpoint.next_increment;
  resume_time_ = checkpoint.time;
  increments_ = checkpoint.increment;
  restore_state(*scene_, *ledger_, checkpoint, solver_->unknowns());
  solver_->resume();
  solver_->restore(checkpoint);
  if (path_ && checkpoint.global.contains("path")) {
    path_->restore(checkpoint);
    resume_path_taken_ = checkpoint.global.at("path_taken").at(0);
  }
}

void Run::open_results() {
  const auto same_place = [&] {
    std::error_code ignored;
    const auto from = std::filesystem::weakly_canonical(*arguments_.restart, ignored).parent_path();
    return from == std::filesystem::weakly_canonical(directory_, ignored);
  };
  const bool goes_on = arguments_.restart && same_place();
  if (!goes_on) resume_time_.reset();
  // A pass of adaptive meshing writes over the files of the one before; only the log goes on.
  const bool later_pass = adaptation_ && adaptation_->pass() > 1;
  prepare_results_directory(comm_, directory_, goes_on || later_pass);
  log_.open(file("log.txt"), goes_on || later_pass);
  fields_ = std::make_unique<FieldsWriter>(scene_->mesh, directory_, scene_->deck.title, resume_time_);
  history_ =
      std::make_unique<HistoryWriter>(comm_, file("history.csv"), history_columns(*scene_, *ledger_), resume_time_);

  const auto& mesh = scene_->mesh;
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  log_.line(formatted("Amontons %s: %s", AMONTONS_VERSION, scene_->deck.title.c_str()));
  log_.line(formatted("  %lld displacement and %lld multiplier unknowns on %d rank%s; %s",
                      static_cast<long long>(mesh.num_global) * mesh.dim,
                      static_cast<long long>(scene_->layout->num_extra()), ranks, ranks == 1 ? "" : "s",
                      solver_->linear_solver().c_str()));
  if (!scene_->floating.empty())
    log_.line("  held by contact alone: " + join_names(scene_->floating) +
              " (their tangent gets a support of 1e-8; the solution carries no artificial force)");
  if (arguments_.restart)
    log_.line(formatted("  restarted from %s at t = %g", arguments_.restart->c_str(), first_time_));
  log_.line("  results in " + directory_);
}

StepPlan Run::plan(std::size_t step) const {
  const auto& steps = scene_->deck.steps;
  StepPlan plan{.begin = step == 0 ? 0.0 : steps[step - 1].to, .end = steps[step].to};
  if (const auto* increments = std::get_if<int>(&steps[step].increments)) {
    plan.equal_increments = *increments;
    plan.smallest = 1.0 / 64;
  } else {
    const auto& automatic = std::get<AutoIncrements>(steps[step].increments);
    plan.equal_increments = 0;
    plan.first = automatic.first;
    plan.smallest = automatic.smallest;
    plan.largest = automatic.largest;
    plan.target_iterations = automatic.target_iterations;
  }
  return plan;
}

Run::Stretch Run::begin_step(std::size_t step) {
  const auto step_plan = plan(step);
  const auto& declared = scene_->deck.steps[step];
  const bool resumed = step == first_step_ && first_time_ > step_plan.begin;
  Stretch stretch{
      .step = step,
      .control = StepControl(step_plan, resumed ? first_time_ : step_plan.begin, resumed ? resume_increment_ : 0.0),
      .path = std::nullopt,
      .name = declared.name.value};
  const auto* automatic = std::get_if<AutoIncrements>(&declared.increments);
  if (automatic && automatic->path_tolerance) {
    stretch.path.emplace(*automatic->path_tolerance, step_plan.end - step_plan.begin);
    if (resumed) stretch.path->set_taken(resume_path_taken_);
  }
  if (!resumed) scene_->problem->forget_course();
  return stretch;
}

int Run::march_step(std::size_t step) {
  auto stretch = begin_step(step);
  int status = status_certified;
  while (status == status_certified && !stretch.control.finished()) {
    const double begun = now(), target = stretch.control.target();
    const auto outcome = solver_->solve(target);
    count(outcome);
    if (stop_requested_)
      status = stop(stretch);
    else if (!outcome.converged)
      status = cut_back(stretch, target, outcome.reason);
    else if (is_cutback_asked_for())
      status = cut_back(stretch, target, "-cutback_at asks for a cutback here, though it was");
    else if (stretch.path || scene_->deck.estimate_path_error)
      status = compare_halves(stretch, outcome, now() - begun);
    else
      status = accept_whole(stretch, outcome);
  }
  return status;
}

/// The option -cutback_at N: the increment after N accepted ones is given up once, although it converged. Nothing but
/// the length of increments may change by that.
bool Run::is_cutback_asked_for() {
  PetscInt after = -1;
  AMT_PETSC(PetscOptionsGetInt(nullptr, nullptr, "-cutback_at", &after, nullptr));
  return after == increments_ && cutbacks_ == 0;
}

void Run::count(const SolveOutcome& outcome) {
  newton_iterations_ += outcome.newton;
  linear_iterations_ += outcome.linear;
  outer_iterations_ += outcome.outer;
  factorizations_ += outcome.factorizations;
}

int Run::stop(const Stretch& stretch) {
  solver_->roll_back();
  write_checkpoint_file(stretch);
  return status_interrupted;
}

int Run::cut_back(Stretch& stretch, double target, const std::string& reason) {
  ++cutbacks_;
  log_.line(formatted("  %s: t = %g not reached: %s", stretch.name.c_str(), target, reason.c_str()));
  if (stretch.control.rejected()) {
    solver_->roll_back();
    return status_certified;
  }
  give_up(stretch, target, reason);
  return status_not_converged;
}

/// Leaves what there is to look at: the last iterate as failed.h5 and failed.xdmf, the last accepted state as
/// checkpoint.
void Run::give_up(const Stretch& stretch, double target, const std::string& reason) {
  log_.line("  no smaller increment is allowed: giving up; the last iterate is in failed.xdmf");
  diagnosis_ = {{"step", stretch.name}, {"time", target}, {"reason", reason}};
  if (const auto& trouble = solver_->trouble()) diagnosis_.update(describe_trouble(*trouble));
  {
    const Phase phase("output");
    FieldsWriter failed(scene_->mesh, directory_, scene_->deck.title + " (not converged)", {}, "failed");
    const auto state = scene_->problem->state_at(solver_->unknowns());
    std::vector<ContactSamples> samples;
    for (auto* contact : scene_->contacts)
      samples.push_back(contact->samples(state));
    write_fields(*scene_, failed, solver_->unknowns(), samples);
  }
  solver_->roll_back();
  write_checkpoint_file(stretch);
}

int Run::accept_whole(Stretch& stretch, const SolveOutcome& outcome) {
  stretch.control.accepted(outcome.newton);
  accept(stretch, outcome, 0.0);
  return status_certified;
}

/// The increment has been solved whole, in `seconds`; solves it in halves, too, and keeps one of the two solutions.
int Run::compare_halves(Stretch& stretch, const SolveOutcome& outcome, double seconds) {
  const double begun = now(), target = stretch.control.target();
  const auto whole = solver_->put_aside(outcome);
  solver_->roll_back();
  SolveOutcome both;
  const auto halves = solver_->solve_halves(target, both);
  count(both);
  if (stop_requested_) return stop(stretch);
  if (stretch.path) {
    path_->add_cost(outcome.newton, seconds);
    if (both.converged) return control_path(stretch, whole, halves, now() - begun);
    path_->add_cost(both.newton, now() - begun);
    return cut_back(stretch, target, both.reason);
  }
  double error = 0.0;
  if (both.converged)
    error = path_->add(difference(whole, halves), KeptSolution::Whole);
  else
    path_->add_unmeasured();
  path_->add_cost(both.newton, now() - begun);
  solver_->revisit(whole);
  stretch.control.accepted(outcome.newton);
  accept(stretch, outcome, error);
  return status_certified;
}

/// Keeps the halves, which took `seconds`, each as an increment of its own, or goes back for a shorter increment.
int Run::control_path(Stretch& stretch, const SolvedState& whole, const std::vector<SolvedState>& halves,
                      double seconds) {
  auto& control = stretch.control;
  const double dt = whole.time - control.now();
  const auto measured = difference(whole, halves);
  const auto verdict = stretch.path->judge(measured.largest(), measured.status, dt);
  const auto sizes =
      formatted("halves differ by %.2e, in status on %.2e of the area", measured.largest(), measured.status);
  if (!verdict.accepted && control.shortened(verdict.factor)) {
    path_->add_rejected();
    path_->add_cost(halves[0].outcome.newton + halves[1].outcome.newton, seconds);
    log_.line(formatted("  %s: t = %g is too far: %s", stretch.name.c_str(), whole.time, sizes.c_str()));
    return status_certified;
  }
  if (!verdict.accepted) {
    path_->add_beyond_tolerance();
    log_.line(formatted("  %s: t = %g is kept for no smaller increment is allowed: %s", stretch.name.c_str(),
                        whole.time, sizes.c_str()));
  }
  stretch.path->spend(measured.largest(), dt);
  const double error = path_->add(measured, KeptSolution::Halves);
  for (const auto& half : halves) {
    const bool second = &half == &halves.back();
    if (second) control.accepted(whole.outcome.newton, verdict.factor);
    solver_->revisit(half);
    accept(stretch, half.outcome, second ? error : 0.0);
  }
  return status_certified;
}

PathDifference Run::difference(const SolvedState& whole, const std::vector<SolvedState>& halves) {
  const auto view = [this](const SolvedState& state) {
    return PathState{.dim = scene_->mesh.dim, .displacement = state.displacement, .samples = state.samples};
  };
  path_->scales.include(path_scales(comm_, view(whole)));
  for (const auto& half : halves)
    path_->scales.include(path_scales(comm_, view(half)));
  return path_difference(comm_, view(whole), view(halves.back()), path_->scales);
}

/// Takes the state in the solver's unknowns; `path_error`: of the increment that ends here, zero if not measured.
void Run::accept(const Stretch& stretch, const SolveOutcome& outcome, double path_error) {
  if (census_) {
    SolveOutcome effort;
    if (const auto words = census_->look(*scene_, *solver_, outcome, effort); !words.empty()) log_.line("  " + words);
    count(effort);
  }
  ++increments_;
  const Vec unknowns = solver_->unknowns();
  ledger_->accept(unknowns);
  const auto state = scene_->problem->state_at(unknowns);
  std::vector<ContactSamples> samples;
  last_totals_.clear();
  for (auto* contact : scene_->contacts) {
    last_totals_.push_back(contact->totals(state));
    samples.push_back(contact->samples(state));
  }
  IncrementReport report{.time = state.time, .outcome = outcome, .path_error = path_error};
  {
    const Phase phase("certificate");
    report.certified =
        certificate_.add(certify_state(*scene_, *ledger_, samples, solver_->accepted(), unknowns), state.time);
  }
  if (motion_) motion_->add(*scene_, solver_->accepted(), unknowns);
  solver_->commit();

  const Phase phase("output");
  history_->row(history_row(*scene_, *ledger_, last_totals_, report));
  progress(stretch.name, report, last_totals_);
  const bool ends_step = report.time >= scene_->deck.steps[stretch.step].to;
  if (ends_step || increments_ % scene_->deck.output.every == 0) write_fields(*scene_, *fields_, unknowns, samples);
  // The state at the very end is estimated in any run.
  if (adaptation_ && ends_step && stretch.step + 1 < scene_->deck.steps.size())
    adaptation_->see(*scene_, estimate_mesh_error(*scene_, unknowns, samples),
                     estimate_figure_errors(*scene_, unknowns, influences_on_figures(*scene_, *solver_, samples)));
  write_checkpoint_file(stretch);
  largest_residual_ = std::max(largest_residual_, outcome.residual);
  last_samples_ = std::move(samples);
}

void Run::write_checkpoint_file(const Stretch& stretch) {
  auto checkpoint = make_checkpoint(*scene_, *ledger_, solver_->unknowns());
  solver_->save(checkpoint);
  checkpoint.step = static_cast<int>(stretch.step);
  checkpoint.increment = increments_;
  checkpoint.next_increment = stretch.control.increment();
  if (path_) {
    path_->save(checkpoint);
    checkpoint.global["path_taken"] = {stretch.path ? stretch.path->taken() : 0.0};
  }
  write_checkpoint(scene_->mesh, file("checkpoint.h5"), run_identity(*scene_), checkpoint);
}

void Run::progress(const std::string& step, const IncrementReport& report, const std::vector<ContactTotals>& totals) {
  const auto& outcome = report.outcome;
  const double end = scene_->deck.steps.back().to;
  const double time = scene_->problem->time();
  const double done = time - first_time_;
  const double left = done > 0.0 ? (now() - started_) * (end - time) / done : 0.0;
  std::string line = formatted("  %-12s t = %-10.6g newton %d", step.c_str(), time, outcome.newton);
  if (outcome.outer > 0) line += formatted(" in %d outer", outcome.outer);
  if (outcome.rung > 0) line += formatted(" by %s", name_of(remedies()[outcome.rung - 1]));
  if (outcome.linear > outcome.newton) line += formatted(", linear %d", outcome.linear);
  line += formatted(", residual %.1e", outcome.residual);
  double pressure = 0.0;
  for (const auto& pair : totals)
    pressure = std::max(pressure, pair.max_pressure);
  if (!totals.empty()) line += formatted(", largest pressure %.6g", pressure);
  if (report.path_error > 0.0) line += formatted(", path error %.1e", report.path_error);
  line += report.certified ? ", certified" : ", NOT CERTIFIED";
  if (left > 0.0) line += formatted(", %.0f s left", std::ceil(left));
  log_.line(line);
}

int Run::march() {
  open_results();
  for (std::size_t step = first_step_; step < scene_->deck.steps.size(); ++step)
    if (const int status = march_step(step); status != status_certified) {
      const char* reason = status == status_interrupted ? "interrupted; checkpoint written" : "did not converge";
      return finish(status, reason);
    }
  return certificate_.passed() ? finish(status_certified, "solved and certified")
                               : finish(status_not_certified, "converged, but the certificate failed");
}

/// Adds errors and effects to the summary, and what they amount to to the log.
void Run::judge_accuracy(int status, nlohmann::ordered_json& summary) {
  if (!last_samples_) return;
  const bool at_end = status == status_certified || status == status_not_certified;
  auto influences = at_end ? influences_on_figures(*scene_, *solver_, *last_samples_)
                           : FigureInfluences{.figures = {}, .reason = "the run did not come to its end"};
  const auto unsolved = at_end ? estimate_unsolved_part(*scene_, *solver_) : UnsolvedPart{};
  solver_->end(); // before estimates, which need memory of their own
  const auto mesh_error = estimate_mesh_error(*scene_, solver_->accepted(), *last_samples_);
  const auto figures = estimate_figure_errors(*scene_, solver_->accepted(), std::move(influences));
  summary["errors"] = error_budget({.scene = *scene_,
                                    .unknowns = solver_->accepted(),
                                    .mesh_error = mesh_error,
                                    .figures = figures,
                                    .certificate = certificate_,
                                    .path = path_ ? &*path_ : nullptr,
                                    .largest_residual = largest_residual_,
                                    .unsolved = unsolved,
                                    .wall_seconds = now() - all_started_});
  summary["effects"] = audit_effects(*scene_, solver_->accepted());
  summary["effects"].update(audit_absent_effects({.scene = *scene_,
                                                  .unknowns = solver_->accepted(),
                                                  .samples = *last_samples_,
                                                  .ledger = *ledger_,
                                                  .motion = motion_ ? &*motion_ : nullptr}));
  log_.line("  " + budget_sentence(summary["errors"]));
  for (const auto& line : audit_warnings(summary["effects"]))
    log_.line("  warning: " + line);
  if (adaptation_) close_pass(mesh_error, figures, summary);
}

/// Hands what the pass has come to to the adaptation, which chooses the next mesh.
void Run::close_pass(const DiscretizationError& mesh_error, const FigureErrors& figures,
                     nlohmann::ordered_json& summary) {
  adaptation_->see(*scene_, mesh_error, figures);
  adaptation_->close(comm_, {.unknowns = num_unknowns(),
                             .cells = summary["scene"]["cells"],
                             .energy = ledger_->stored_energy(),
                             .pairs = last_totals_,
                             .mesh_error = mesh_error.relative(),
                             .figure = adaptation_->figure_error(figures),
                             .wall_seconds = now() - started_});
  summary["adapt"] = adaptation_->to_json();
  log_.line("  " + adaptation_->sentence());
}

int Run::finish(int status, const std::string& reason) {
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  nlohmann::ordered_json summary;
  summary["status"] = status;
  summary["outcome"] = reason;
  summary["version"] = AMONTONS_VERSION;
  summary["title"] = scene_->deck.title;
  summary["deck"] = arguments_.deck;
  summary["ranks"] = ranks;
  summary["scene"] = describe_scene(*scene_);
  summary["linear_solver"] = solver_->linear_solver();
  summary["increments"] = increments_;
  summary["cutbacks"] = cutbacks_;
  summary["newton_iterations"] = newton_iterations_;
  summary["linear_iterations"] = linear_iterations_;
  summary["outer_iterations"] = outer_iterations_;
  summary["factorizations"] = factorizations_;
  summary["remedies"] = describe_remedies(solver_->remedy_uses());
  summary["remedies"]["cutbacks"] = cutbacks_;
  summary["remedies"]["supported_bodies"] = scene_->floating;
  if (!diagnosis_.is_null()) summary["diagnosis"] = diagnosis_;
  summary["time"] = scene_->problem->time();
  summary["contact"] = contact_results(*scene_, *ledger_, last_totals_);
  summary["energy"] = {{"stored", ledger_->stored_energy()},
                       {"dissipated", ledger_->dissipated_energy()},
                       {"external_work", ledger_->external_work()},
                       {"artificial_work", ledger_->artificial_work()},
                       {"external_work_uncertainty", ledger_->work_uncertainty()}};
  if (census_) summary["other_solutions"] = census_->to_json();
  if (path_) summary["path"] = path_->to_json();
  summary["certificate"] = certificate_.to_json();
  judge_accuracy(status, summary);
  summary["resources"] = resources(comm_, now() - all_started_); // as times of phases, CPU and memory: of all passes
  write_summary(comm_, file("summary.json"), summary);
  for (const auto& line : certificate_.failures(scene_->deck))
    log_.line("  certificate: " + line);
  log_.line(formatted("%s after %d increments, %d Newton iterations, %.2f s", reason.c_str(), increments_,
                      newton_iterations_, now() - all_started_));
  return status;
}

} // namespace

namespace {

/// Whole runs on one mesh after the other. A pass that failed its certificate goes on to the next all the same: meshes
/// that are far too coarse often do.
int run_passes(MPI_Comm comm, const RunArguments& arguments, const Deck& deck) {
  if (arguments.restart)
    throw UserError(
        "--restart: a run with `adapt` cannot go on from a checkpoint, for its mesh is made anew. Run it from "
        "the start, without --restart.");
  Adaptation adaptation(deck);
  for (;;) {
    Run pass(comm, arguments, deck, &adaptation);
    if (!adaptation.fits(pass.num_unknowns())) continue;
    const int status = pass.march();
    const bool solved = status == status_certified || status == status_not_certified;
    if (!solved || !adaptation.goes_on()) return status;
  }
}

} // namespace

int run(MPI_Comm comm, const RunArguments& arguments) {
  const auto deck = read_deck(comm, arguments.deck);
  if (deck.adapt) return run_passes(comm, arguments, deck);
  return Run(comm, arguments, deck, nullptr).march();
}

} // namespace amontons
