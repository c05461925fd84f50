// Dense systems condensed onto what changes have the solutions that whole factorizations find.
#include "solve/changing_block.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

using namespace amontons;

namespace {

/// Unsymmetric, with zeros on half of the diagonal as multipliers have them, and regular.
std::vector<double> made_up(int size) {
  std::vector<double> values(std::size_t(size) * size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      values[std::size_t(j) * size + i] = std::sin(1.7 * i * i + 0.9 * j) + (i % 2 == 0 && i == j ? 8.0 : 0.0);
  for (int i = 1; i < size; i += 2)
    values[std::size_t(i) * size + i] = 0.0;
  return values;
}

/// Largest entry of b − (S + Δ) x relative to that of b.
double defect(const std::vector<double>& matrix, const std::vector<ChangingBlock::Change>& changes,
              const std::vector<double>& right, const std::vector<double>& solution) {
  const auto size = right.size();
  auto rest = right;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      rest[i] -= matrix[j * size + i] * solution[j];
  for (const auto& change : changes)
    rest[change.row] -= change.value * solution[change.column];
  const auto largest = [](const std::vector<double>& v) {
    return std::abs(
        *std::max_element(v.begin(), v.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
  };
  return largest(rest) / largest(right);
}

} // namespace

TEST_CASE("a changing block solves with whatever equations change") {
  constexpr int size = 24;
  const auto matrix = made_up(size);
  ChangingBlock block(matrix, size);
  std::vector<double> right(size);
  for (int i = 0; i < size; ++i)
    right[i] = std::cos(i);
  const std::vector<ChangingBlock::Change> changes = {{3, 7, 5.0}, {7, 3, -2.0}, {7, 7, 4.0}};
  CHECK_FALSE(block.covers({}));
  std::vector<int> all(size), some = {3, 7, 20}, more = {0, 1, 3, 7, 8, 9, 20, 23};
  for (int i = 0; i < size; ++i)
    all[i] = i;
  for (const auto& changing : {some, more, all, some}) {
    CAPTURE(changing.size());
    REQUIRE(block.set_changing(changing));
    REQUIRE(block.covers(changes));
    CHECK(block.covers(std::vector<ChangingBlock::Change>{{3, 22, 1.0}}) == (changing == all));
    auto changed = right;
    REQUIRE(block.factorize(changes));
    block.solve(changed);
    CHECK(defect(matrix, changes, right, changed) < 1e-12);
    auto plain = right;
    REQUIRE(block.factorize({}));
    block.solve(plain);
    CHECK(defect(matrix, {}, right, plain) < 1e-12);
    double difference = 0.0;
    for (int i = 0; i < size; ++i)
      difference = std::max(difference, std::abs(changed[i] - plain[i]));
    CHECK(difference > 1e-3); // the changes matter
    const auto product = block.times_reference(plain);
    for (int i = 0; i < size; ++i)
      CHECK(product[i] == doctest::Approx(right[i]).epsilon(1e-12));
  }
  REQUIRE(block.set_changing({}));
  CHECK(block.covers({}));
  REQUIRE(block.factorize({}));
  block.solve(right);
  CHECK(std::isfinite(right[0]));
}

TEST_CASE("a changing block says what is singular") {
  // A chain of two masses that the third equation alone would hold: singular until that changes.
  const std::vector<double> chain = {1.0, -1.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  ChangingBlock block(chain, 3);
  CHECK_FALSE(block.set_changing({}));
  CHECK_FALSE(block.covers({}));
  REQUIRE(block.set_changing({1}));
  CHECK_FALSE(block.factorize({}));
  REQUIRE(block.factorize(std::vector<ChangingBlock::Change>{{1, 1, 2.0}}));
  std::vector<double> vector = {1.0, 1.0, 4.0}; // x_0 − x_1 = 1, −x_0 + 3 x_1 = 1
  block.solve(vector);
  CHECK(vector[0] == doctest::Approx(2.0));
  CHECK(vector[1] == doctest::Approx(1.0));
  CHECK(vector[2] == doctest::Approx(4.0));
}
