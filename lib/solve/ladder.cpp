#include "solve/ladder.hpp"

#include "base/error.hpp"
#include "base/log.hpp"

#include <algorithm>
#include <sstream>

namespace amontons {

namespace {

constexpr int most_pivots = 200, most_lags = 30;
/// Imbalance, relative to the forces in play, at which lagging the bounds has done its work.
constexpr double lagged_enough = 1e-4;
constexpr double softer[] = {1e-3, 1e-2, 1e-1};
constexpr double strongest_support = 1.0, weakest_support = 1e-6, support_factor = 0.1;

/// Runs at the end of a scope, whatever happens in it.
template <class Work>
class AtEnd {
 public:
  explicit AtEnd(Work work) : work_(std::move(work)) {}
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;
  ~AtEnd() { work_(); }

 private:
  Work work_;
};

/// Adds the effort of the solves before the last one to it.
class Effort {
 public:
  const SolveOutcome& add(const SolveOutcome& outcome) {
    sum_.add_effort(outcome);
    last_ = outcome;
    return last_;
  }
  SolveOutcome total() const {
    SolveOutcome total = last_;
    total.newton = total.linear = total.outer = total.factorizations = 0;
    total.add_effort(sum_);
    return total;
  }

 private:
  SolveOutcome sum_, last_;
};

} // namespace

const std::array<Remedy, std::variant_size_v<Remedy>>& remedies() {
  static const std::array<Remedy, std::variant_size_v<Remedy>> rungs = {
      MeritSearch{}, HeldPoints{}, LaggedLimits{}, SofterAugmentation{}, LoopOnMultipliers{}, VanishingSupport{}};
  return rungs;
}

const char* name_of(const Remedy& remedy) {
  struct Names {
    const char* operator()(MeritSearch) const { return "merit_search"; }
    const char* operator()(HeldPoints) const { return "held_points"; }
    const char* operator()(LaggedLimits) const { return "lagged_friction"; }
    const char* operator()(SofterAugmentation) const { return "softer_augmentation"; }
    const char* operator()(LoopOnMultipliers) const { return "uzawa_loop"; }
    const char* operator()(VanishingSupport) const { return "vanishing_support"; }
  };
  return std::visit(Names{}, remedy);
}

std::set<std::size_t> chosen_rungs() {
  std::set<std::size_t> chosen;
  std::array<char, 256> text{};
  PetscBool is_given = PETSC_FALSE;
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, "-remedies", text.data(), text.size(), &is_given));
  std::vector<std::string> names;
  for (const auto& rung : remedies())
    names.emplace_back(name_of(rung));
  if (!is_given) {
    for (std::size_t rung = 0; rung < names.size(); ++rung)
      chosen.insert(rung);
    return chosen;
  }
  std::istringstream words(text.data());
  for (std::string word; std::getline(words, word, ',');) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end() && word != "none")
      throw UserError("-remedies: there is no remedy '" + word + "'. There are " + join_names(names) +
                      " (several separated by commas), and `none`.");
    if (found != names.end()) chosen.insert(static_cast<std::size_t>(found - names.begin()));
  }
  return chosen;
}

Ladder::Ladder(Problem& problem, IncrementNewton& newton, Hooks hooks)
    : problem_(problem), newton_(newton), hooks_(std::move(hooks)), forms_(newton.switching()), chosen_(chosen_rungs()),
      uses_(remedies().size()) {}

bool Ladder::applies(const Remedy& remedy, const Trouble& trouble) const {
  if (std::holds_alternative<HeldPoints>(remedy))
    return newton_.watch().has_points() && newton_.watch().name(on_and_off_, 0).count > 0;
  if (std::holds_alternative<LaggedLimits>(remedy))
    return std::any_of(forms_.begin(), forms_.end(), [](const auto* form) { return form->has_limits(); });
  if (std::holds_alternative<SofterAugmentation>(remedy)) return newton_.watch().has_points();
  if (std::holds_alternative<LoopOnMultipliers>(remedy)) return hooks_.loop != nullptr;
  if (std::holds_alternative<VanishingSupport>(remedy)) return !trouble.free.empty();
  return true;
}

void Ladder::note_flipping() {
  if (newton_.watch().has_points())
    on_and_off_ = newton_.watch().flipping(StatusWatch::most_looks, StatusWatch::Flip::OffOn);
}

SolveOutcome Ladder::start_over(const Remedy& remedy, Vec unknowns) {
  hooks_.restart();
  return std::visit([&](const auto& alternative) { return use(alternative, unknowns); }, remedy);
}

SolveOutcome Ladder::attempt(const Remedy& remedy, Vec unknowns) {
  note_flipping();
  return start_over(remedy, unknowns);
}

SolveOutcome Ladder::climb(Vec unknowns, const SolveOutcome& failed, const Trouble& trouble) {
  SolveOutcome outcome = failed;
  note_flipping();
  for (std::size_t rung = 0; rung < remedies().size(); ++rung) {
    const auto& remedy = remedies()[rung];
    if (chosen_.count(rung) == 0 || spent_.count(rung) > 0 || !applies(remedy, trouble)) continue;
    ++uses_[rung].tried;
    const auto tried = start_over(remedy, unknowns);
    outcome.add_effort(tried);
    outcome.interrupted = tried.interrupted;
    if (tried.interrupted) return outcome;
    hooks_.tell(formatted("remedy %s: %s after %d iterations", name_of(remedy),
                          tried.converged ? "converged" : tried.reason.c_str(), tried.newton));
    if (tried.converged) {
      ++uses_[rung].helped;
      outcome.converged = true;
      outcome.residual = tried.residual;
      outcome.reason = tried.reason;
      outcome.rung = static_cast<int>(rung) + 1;
      return outcome;
    }
    spent_.insert(rung);
  }
  return outcome;
}

SolveOutcome Ladder::use(MeritSearch, Vec) {
  newton_.set_steps(MeritSteps{});
  const AtEnd back([&] { newton_.set_steps(ChosenSteps{}); });
  return hooks_.solve();
}

/// Solves with points held until none of them wants to be elsewhere.
SolveOutcome Ladder::pivot(Vec unknowns) {
  using Hold = Switching::Hold;
  std::vector<std::vector<Hold>> holds;
  for (std::size_t f = 0; f < forms_.size(); ++f) {
    const auto branches = forms_[f]->branches();
    auto& hold = holds.emplace_back(branches.size(), Hold::Free);
    for (std::size_t i = 0; i < hold.size(); ++i)
      if (on_and_off_[f][i]) hold[i] = branches[i] ? Hold::On : Hold::Off;
  }
  Effort effort;
  const AtEnd let_go([&] {
    for (auto* form : forms_)
      form->hold({});
  });
  for (int step = 0; step < most_pivots; ++step) {
    for (std::size_t f = 0; f < forms_.size(); ++f)
      forms_[f]->hold(holds[f]);
    if (!effort.add(newton_.solve(unknowns)).converged) break;
    Marks elsewhere;
    for (std::size_t f = 0; f < forms_.size(); ++f) {
      const auto wanted = forms_[f]->wanted();
      auto& marks = elsewhere.emplace_back(wanted.size(), std::uint8_t(0));
      for (std::size_t i = 0; i < wanted.size(); ++i)
        marks[i] = holds[f][i] != Hold::Free && (wanted[i] != 0) != (holds[f][i] == Hold::On);
    }
    const auto first = newton_.watch().name(elsewhere, 1).first;
    if (first.empty()) break;
    for (std::size_t f = 0; f < forms_.size(); ++f)
      for (std::size_t i = 0; i < holds[f].size(); ++i)
        if (elsewhere[f][i] && forms_[f]->switch_name() == first[0].name &&
            forms_[f]->switch_place(i) == first[0].place)
          holds[f][i] = holds[f][i] == Hold::On ? Hold::Off : Hold::On;
  }
  return effort.total();
}

SolveOutcome Ladder::use(HeldPoints, Vec unknowns) {
  newton_.imbalance(unknowns); // evaluates the branches at the start
  Effort effort;
  if (effort.add(pivot(unknowns)).converged) effort.add(hooks_.solve());
  return effort.total();
}

SolveOutcome Ladder::use(LaggedLimits, Vec unknowns) {
  Effort effort;
  const auto release = [&] {
    for (auto* form : forms_)
      form->release_limits();
  };
  for (int lag = 0; lag < most_lags && (newton_.imbalance(unknowns) > lagged_enough || lag == 0); ++lag) {
    for (auto* form : forms_)
      form->hold_limits();
    const AtEnd let_go(release);
    if (!effort.add(newton_.solve(unknowns)).converged) return effort.total();
  }
  effort.add(hooks_.solve());
  return effort.total();
}

SolveOutcome Ladder::use(SofterAugmentation, Vec unknowns) {
  Effort effort;
  {
    const AtEnd back([&] {
      for (auto* form : forms_)
        form->scale_augmentation(1.0);
    });
    for (const double factor : softer) {
      for (auto* form : forms_)
        form->scale_augmentation(factor);
      if (!effort.add(newton_.solve(unknowns)).converged) return effort.total();
    }
  }
  effort.add(hooks_.solve());
  return effort.total();
}

SolveOutcome Ladder::use(LoopOnMultipliers, Vec unknowns) {
  newton_.imbalance(unknowns); // takes the multipliers from the unknowns
  Effort effort;
  if (effort.add(hooks_.loop()).converged) effort.add(hooks_.solve());
  return effort.total();
}

SolveOutcome Ladder::use(VanishingSupport, Vec unknowns) {
  Effort effort;
  {
    const AtEnd alone([&] { problem_.stand_alone(); });
    for (double ratio = strongest_support; ratio >= 0.99 * weakest_support; ratio *= support_factor) {
      const auto support = hooks_.make_support(ratio);
      problem_.lean_on(*support);
      if (!effort.add(newton_.solve(unknowns)).converged) return effort.total();
    }
  }
  effort.add(hooks_.solve());
  return effort.total();
}

} // namespace amontons
