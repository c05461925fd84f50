#include "solve/other_starts.hpp"

namespace amontons {

namespace {

/// Lets points and limits go at the end of a scope, whatever happens in it.
class LetGo {
 public:
  explicit LetGo(const std::vector<Switching*>& forms) : forms_(forms) {}
  LetGo(const LetGo&) = delete;
  LetGo& operator=(const LetGo&) = delete;
  ~LetGo() {
    for (auto* form : forms_) {
      form->hold({});
      form->release_limits();
    }
  }

 private:
  const std::vector<Switching*>& forms_;
};

} // namespace

const std::array<OtherStart, std::variant_size_v<OtherStart>>& other_starts() {
  static const std::array<OtherStart, std::variant_size_v<OtherStart>> starts = {AllOpen{}, Frictionless{}};
  return starts;
}

SolveOutcome go_to(const OtherStart& start, Problem& problem, Newton& newton, Vec unknowns) {
  const auto forms = problem.switching();
  const LetGo at_end(forms);
  for (auto* form : forms)
    form->hold(std::vector(form->branches().size(), Switching::Hold::Off));
  auto outcome = newton.solve(unknowns);
  if (!outcome.converged || std::holds_alternative<AllOpen>(start)) return outcome;
  const auto residual = problem.layout().new_vector();
  problem.residual(unknowns, residual); // open points carry nothing, so the limits that are held now are zero
  for (auto* form : forms) {
    form->hold_limits();
    form->hold({});
  }
  const auto opened = outcome;
  outcome = newton.solve(unknowns);
  outcome.add_effort(opened);
  return outcome;
}

} // namespace amontons
