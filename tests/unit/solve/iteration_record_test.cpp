// What the course of an iteration says: made-up sequences whose cycle is known.
#include "solve/iteration_record.hpp"

#include <doctest/doctest.h>
#include <initializer_list>

using amontons::IterationRecord;

namespace {

/// Iterates with these patterns whose residual changes by `factor` from one to the next, or goes with the pattern.
IterationRecord record_of(std::initializer_list<std::uint64_t> patterns, double factor) {
  IterationRecord record;
  double residual = 1.0;
  for (const auto pattern : patterns)
    record.add({.pattern = pattern, .changed = 0.0, .residual = residual *= factor});
  return record;
}
IterationRecord periodic(std::initializer_list<std::uint64_t> patterns) {
  IterationRecord record;
  for (const auto pattern : patterns)
    record.add({.pattern = pattern, .changed = 0.0, .residual = 0.1 * static_cast<double>(pattern)});
  return record;
}

} // namespace

TEST_CASE("the length of a cycle is found, and only when it has been gone through three times") {
  CHECK(periodic({9, 8, 1, 2, 1, 2, 1, 2}).cycle() == 2);
  CHECK(periodic({9, 1, 2, 3, 1, 2, 3, 1, 2, 3}).cycle() == 3);
  CHECK(periodic({1, 1, 2, 1, 1, 2, 1, 1, 2}).cycle() == 3);
  CHECK(periodic({9, 8, 1, 2, 1, 2}).cycle() == 0);
  CHECK(periodic({1, 2, 1, 2, 1, 2, 7}).cycle() == 0);
  CHECK(periodic({5, 4, 3, 2, 1}).cycle() == 0);
  CHECK(periodic({}).cycle() == 0);
}

TEST_CASE("branches that repeat while the residual falls are no cycle, nor are branches that rest") {
  CHECK(record_of({1, 2, 1, 2, 1, 2, 1, 2}, 0.9).cycle() == 0);
  CHECK(record_of({1, 2, 1, 2, 1, 2, 1, 2}, 1.0).cycle() == 2);
  CHECK(record_of({3, 3, 3, 3, 3, 3}, 1.0).cycle() == 0);
}

TEST_CASE("rest is a residual that stays where it is with the same branches") {
  CHECK(record_of({4, 1, 1, 1, 1, 1, 1, 1, 1}, 1.0).rests());
  CHECK_FALSE(record_of({1, 1, 1, 1, 1, 1, 1}, 1.0).rests());
  CHECK_FALSE(record_of({1, 1, 1, 1, 1, 1, 1, 1}, 0.99).rests());
  CHECK_FALSE(record_of({1, 1, 1, 1, 2, 1, 1, 1}, 1.0).rests());
}

TEST_CASE("the largest change leaves out the first step, which goes from a guess") {
  IterationRecord record;
  for (const double changed : {0.0, 0.9, 0.2, 0.5, 0.1})
    record.add({.pattern = 0, .changed = changed, .residual = 1.0});
  CHECK(record.largest_change() == 0.5);
}
