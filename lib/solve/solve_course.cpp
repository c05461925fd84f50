#include "solve/solve_course.hpp"

namespace amontons {

void SolveCourse::clear() {
  record_.clear();
  watch_.clear();
}

void SolveCourse::observe(double residual) {
  const auto look = watch_.look();
  record_.add({.pattern = look.pattern, .changed = look.changed, .residual = residual});
}

void SolveCourse::describe(Trouble& trouble) const {
  constexpr std::size_t most_named = 3;
  trouble.cycle = record_.cycle();
  trouble.rests = record_.rests();
  trouble.largest_change = record_.largest_change();
  if (!watch_.has_points()) return;
  const std::size_t looks = trouble.rests       ? 1
                            : trouble.cycle > 0 ? static_cast<std::size_t>(trouble.cycle) + 1
                                                : StatusWatch::most_looks;
  const auto named = watch_.name(watch_.flipping(looks, StatusWatch::Flip::Branch), most_named);
  trouble.num_flipping = named.count;
  trouble.points = named.first;
}

} // namespace amontons
