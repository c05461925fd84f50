#include "run.hpp"

#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/log.hpp"
#include "base/timer.hpp"
#include "certify.hpp"
#include "ledger.hpp"
#include "output/history.hpp"
#include "output/results_directory.hpp"
#include "output/summary.hpp"
#include "report.hpp"
#include "scene.hpp"
#include "solve/bounded_newton.hpp"
#include "solve/step_control.hpp"
#include "solve/uzawa.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

constexpr int status_certified = 0, status_not_converged = 3, status_not_certified = 4, status_interrupted = 5;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// One run: owns the solver and the writers, marches through the steps.
class Run {
 public:
  Run(MPI_Comm comm, const RunArguments& arguments);
  int march();

 private:
  void open_results();
  void restart();
  StepPlan plan(std::size_t step) const;
  SolveOutcome solve_increment(double target);
  /// Exit status of the step, status_certified to go on.
  int march_step(std::size_t step);
  void accept(std::size_t step, const SolveOutcome& outcome, double next_increment, bool step_ends);
  void write_checkpoint_file(std::size_t step, double next_increment);
  void progress(const std::string& step, const SolveOutcome& outcome, const std::vector<ContactTotals>& totals,
                bool certified);
  int finish(int status, const std::string& reason);
  std::string file(const char* name) const { return directory_ + "/" + name; }

  MPI_Comm comm_;
  RunArguments arguments_;
  InterruptScope interrupt_;
  double started_ = now();
  Log log_;
  std::unique_ptr<Scene> scene_;
  std::string directory_, solver_;
  std::unique_ptr<Newton> newton_; // absent with bounded_
  std::unique_ptr<BoundedNewton> bounded_;
  std::unique_ptr<UzawaLoop> uzawa_;
  std::unique_ptr<Ledger> ledger_;
  std::unique_ptr<FieldsWriter> fields_;
  std::unique_ptr<HistoryWriter> history_;
  VecHandle unknowns_, accepted_;
  std::size_t first_step_ = 0;
  std::optional<double> resume_time_;
  double first_time_ = 0.0, resume_increment_ = 0.0;
  bool stop_requested_ = false;
  // Counts for the summary.
  int increments_ = 0, cutbacks_ = 0, newton_iterations_ = 0, linear_iterations_ = 0, outer_iterations_ = 0,
      factorizations_ = 0;
  CertificateRecord certificate_;
  std::vector<ContactTotals> last_totals_;
};

Run::Run(MPI_Comm comm, const RunArguments& arguments) : comm_(comm), arguments_(arguments), log_(comm) {
  scene_ = build_scene(comm, arguments.deck);
  for (const auto& [name, value] : scene_->deck.petsc)
    default_option("-" + name, value);
  directory_ = arguments.out.value_or(scene_->deck.output.directory);
  unknowns_ = scene_->layout->new_vector();
  accepted_ = scene_->layout->new_vector();
  ledger_ = std::make_unique<Ledger>(*scene_);
  const auto stop = [this] { return stop_requested_ = interrupted(comm_); };
  if (scene_->bounds) {
    solver_ = choose_bounded_solver(*scene_->problem);
    bounded_ = std::make_unique<BoundedNewton>(*scene_->problem, *scene_->bounds, stop);
  } else {
    solver_ = choose_linear_solver(*scene_->problem);
    newton_ = std::make_unique<Newton>(*scene_->problem, stop);
  }
  if (scene_->multipliers) {
    double tolerance = 1.0;
    int iterations = 0;
    for (const auto& pair : scene_->deck.contact)
      if (const auto* uzawa = std::get_if<UzawaDeck>(&pair.enforce)) {
        tolerance = std::min(tolerance, uzawa->tolerance);
        iterations = std::max(iterations, uzawa->max_iterations);
      }
    uzawa_ = std::make_unique<UzawaLoop>(*scene_->problem, *newton_, *scene_->multipliers, tolerance, iterations);
  }
  if (arguments_.restart) restart();
  open_results();
}

void Run::restart() {
  for (const auto* contact : scene_->contacts)
    if (contact->tangential())
      throw UserError(
          "--restart: the contact pair '" + contact->pair().name +
          "' has friction, whose history at the points of the surface the checkpoint does not hold. Run the "
          "deck from its start.");
  const auto checkpoint = read_checkpoint(scene_->mesh, *arguments_.restart, run_identity(*scene_));
  // By time and not by number: the deck may have got more or longer steps since.
  const auto& steps = scene_->deck.steps;
  while (first_step_ < steps.size() && steps[first_step_].to <= checkpoint.time * (1.0 + 1e-12))
    ++first_step_;
  first_time_ = checkpoint.time;
  resume_increment_ = checkpoint.next_increment;
  resume_time_ = checkpoint.time;
  increments_ = checkpoint.increment;
  restore_unknowns(*scene_, checkpoint, unknowns_);
  scene_->problem->begin_increment(checkpoint.time, unknowns_);
  const auto residual = scene_->layout->new_vector();
  scene_->problem->residual(unknowns_, residual);
  ledger_->restore(unknowns_, checkpoint.global.at("work")[0], checkpoint.global.at("work")[1]);
  scene_->problem->commit(unknowns_);
  AMT_PETSC(VecCopy(unknowns_, accepted_));
}

void Run::open_results() {
  const auto same_place = [&] {
    std::error_code ignored;
    const auto from = std::filesystem::weakly_canonical(*arguments_.restart, ignored).parent_path();
    return from == std::filesystem::weakly_canonical(directory_, ignored);
  };
  const bool goes_on = arguments_.restart && same_place();
  if (!goes_on) resume_time_.reset();
  prepare_results_directory(comm_, directory_, goes_on);
  log_.open(file("log.txt"), goes_on);
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
                      solver_.c_str()));
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

SolveOutcome Run::solve_increment(double target) {
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  scene_->problem->begin_increment(target, unknowns_);
  if (bounded_) return bounded_->solve(unknowns_);
  return uzawa_ ? uzawa_->solve(unknowns_) : newton_->solve(unknowns_);
}

int Run::march_step(std::size_t step) {
  const auto& name = scene_->deck.steps[step].name.value;
  const auto step_plan = plan(step);
  const bool resumed = step == first_step_ && first_time_ > step_plan.begin;
  StepControl control(step_plan, resumed ? first_time_ : step_plan.begin, resumed ? resume_increment_ : 0.0);
  while (!control.finished()) {
    const double target = control.target();
    const auto outcome = solve_increment(target);
    newton_iterations_ += outcome.newton;
    linear_iterations_ += outcome.linear;
    outer_iterations_ += outcome.outer;
    factorizations_ += outcome.factorizations;
    if (stop_requested_) {
      AMT_PETSC(VecCopy(accepted_, unknowns_));
      scene_->problem->roll_back();
      write_checkpoint_file(step, control.increment());
      return status_interrupted;
    }
    if (!outcome.converged) {
      ++cutbacks_;
      scene_->problem->roll_back();
      log_.line(formatted("  %s: t = %g not reached: %s", name.c_str(), target, outcome.reason.c_str()));
      if (!control.rejected()) {
        log_.line("  no smaller increment is allowed: giving up");
        return status_not_converged;
      }
      continue;
    }
    control.accepted(outcome.newton);
    accept(step, outcome, control.increment(), control.finished());
  }
  return status_certified;
}

void Run::accept(std::size_t step, const SolveOutcome& outcome, double next_increment, bool step_ends) {
  ++increments_;
  ledger_->accept(unknowns_);
  const auto state = scene_->problem->state_at(unknowns_);
  std::vector<ContactSamples> samples;
  last_totals_.clear();
  for (auto* contact : scene_->contacts) {
    last_totals_.push_back(contact->totals(state));
    samples.push_back(contact->samples(state));
  }
  bool certified = false;
  {
    const Phase phase("certificate");
    certified = certificate_.add(certify_state(*scene_, *ledger_, samples, accepted_, unknowns_), state.time);
  }
  const double time = state.time;
  scene_->problem->commit(unknowns_);
  AMT_PETSC(VecCopy(unknowns_, accepted_));

  const Phase phase("output");
  history_->row(
      history_row(*scene_, *ledger_, last_totals_, {.time = time, .outcome = outcome, .certified = certified}));
  progress(scene_->deck.steps[step].name.value, outcome, last_totals_, certified);
  if (step_ends || increments_ % scene_->deck.output.every == 0) write_fields(*scene_, *fields_, unknowns_, samples);
  write_checkpoint_file(step, next_increment);
}

void Run::write_checkpoint_file(std::size_t step, double next_increment) {
  scene_->problem->state_at(unknowns_);
  auto checkpoint = make_checkpoint(*scene_, *ledger_, unknowns_);
  checkpoint.step = static_cast<int>(step);
  checkpoint.increment = increments_;
  checkpoint.next_increment = next_increment;
  write_checkpoint(scene_->mesh, file("checkpoint.h5"), run_identity(*scene_), checkpoint);
}

void Run::progress(const std::string& step, const SolveOutcome& outcome, const std::vector<ContactTotals>& totals,
                   bool certified) {
  const double end = scene_->deck.steps.back().to;
  const double time = scene_->problem->time();
  const double done = time - first_time_;
  const double left = done > 0.0 ? (now() - started_) * (end - time) / done : 0.0;
  std::string line = formatted("  %-12s t = %-10.6g newton %d", step.c_str(), time, outcome.newton);
  if (outcome.outer > 0) line += formatted(" in %d outer", outcome.outer);
  if (outcome.linear > outcome.newton) line += formatted(", linear %d", outcome.linear);
  line += formatted(", residual %.1e", outcome.residual);
  double pressure = 0.0;
  for (const auto& pair : totals)
    pressure = std::max(pressure, pair.max_pressure);
  if (!totals.empty()) line += formatted(", largest pressure %.6g", pressure);
  line += certified ? ", certified" : ", NOT CERTIFIED";
  if (left > 0.0) line += formatted(", %.0f s left", std::ceil(left));
  log_.line(line);
}

int Run::march() {
  for (std::size_t step = first_step_; step < scene_->deck.steps.size(); ++step)
    if (const int status = march_step(step); status != status_certified) {
      const char* reason = status == status_interrupted ? "interrupted; checkpoint written" : "did not converge";
      return finish(status, reason);
    }
  return certificate_.passed() ? finish(status_certified, "solved and certified")
                               : finish(status_not_certified, "converged, but the certificate failed");
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
  summary["linear_solver"] = solver_;
  summary["increments"] = increments_;
  summary["cutbacks"] = cutbacks_;
  summary["newton_iterations"] = newton_iterations_;
  summary["linear_iterations"] = linear_iterations_;
  summary["outer_iterations"] = outer_iterations_;
  summary["factorizations"] = factorizations_;
  summary["remedies"] = {{"cutbacks", cutbacks_}, {"supported_bodies", scene_->floating}};
  summary["time"] = scene_->problem->time();
  nlohmann::ordered_json results;
  for (std::size_t i = 0; i < last_totals_.size(); ++i)
    results[scene_->contacts[i]->pair().name] = {{"force", last_totals_[i].force},
                                                 {"area", last_totals_[i].area},
                                                 {"max_pressure", last_totals_[i].max_pressure},
                                                 {"largest_penetration", last_totals_[i].largest_penetration}};
  summary["contact"] = results;
  summary["energy"] = {{"stored", ledger_->stored_energy()},
                       {"dissipated", ledger_->dissipated_energy()},
                       {"external_work", ledger_->external_work()},
                       {"external_work_uncertainty", ledger_->work_uncertainty()}};
  summary["certificate"] = certificate_.to_json();
  summary["resources"] = resources(comm_, now() - started_);
  write_summary(comm_, file("summary.json"), summary);
  for (const auto& line : certificate_.failures())
    log_.line("  certificate: " + line);
  log_.line(formatted("%s after %d increments, %d Newton iterations, %.2f s", reason.c_str(), increments_,
                      newton_iterations_, now() - started_));
  return status;
}

} // namespace

int run(MPI_Comm comm, const RunArguments& arguments) { return Run(comm, arguments).march(); }

} // namespace amontons
