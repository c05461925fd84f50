// Sizes of cells from their errors: the optimum in closed form, its limits, and that nothing near it is better.
#include "../form/box_mesh.hpp"
#include "accuracy/mesh_sizes.hpp"
#include "accuracy/sequence_error.hpp"

#include <array>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

std::vector<CellError> two_kinds(double rate) {
  std::vector<CellError> cells(30, {.edge = 1.0, .square = 1e-4, .rate = rate});
  cells.resize(40, {.edge = 0.5, .square = 9e-3, .rate = rate});
  return cells;
}

/// Ratio of the sizes of the first and the last cell.
std::array<double, 2> ratios(std::span<const CellError> cells, const WantedSizes& wanted) {
  return {wanted.samples.front().size / cells.front().edge, wanted.samples.back().size / cells.back().edge};
}

} // namespace

TEST_CASE("mesh sizes: new cells share the error evenly, and add up to the target") {
  for (const int dim : {2, 3})
    for (const double rate : {1.0, 2.0}) {
      const auto cells = two_kinds(rate);
      const SizeRule rule{.dim = dim, .target = 0.1, .most_cells = 1e9, .finest = 1e-3, .coarsest = 1e3};
      const auto wanted = wanted_sizes(cells, rule);
      const auto [first, last] = ratios(cells, wanted);
      const double power = 2.0 * rate + dim;
      CHECK(1e-4 * std::pow(first, power) == doctest::Approx(9e-3 * std::pow(last, power)).epsilon(0.01));
      CHECK(wanted.error == doctest::Approx(rule.target));
      CHECK(30 * 1e-4 * std::pow(first, 2 * rate) + 10 * 9e-3 * std::pow(last, 2 * rate) ==
            doctest::Approx(0.01).epsilon(0.005)); // sizes have four digits
      CHECK(wanted.cells == doctest::Approx(30 * std::pow(first, -dim) + 10 * std::pow(last, -dim)).epsilon(0.005));
      // Any other division with the same error has more cells: shift error from one kind to the other and back.
      for (const double shift : {0.9, 1.1}) {
        const double moved = first * shift;
        const double rest = (0.01 - 30 * 1e-4 * std::pow(moved, 2 * rate)) / (10 * 9e-3);
        REQUIRE(rest > 0.0);
        CHECK(30 * std::pow(moved, -dim) + 10 * std::pow(rest, -dim / (2 * rate)) > wanted.cells);
      }
    }
}

TEST_CASE("mesh sizes: limits of the ratio and of the number of cells") {
  const auto cells = two_kinds(1.0);
  const auto unreachable = wanted_sizes(cells, {.dim = 2, .target = 1e-9, .most_cells = 1e9});
  CHECK(ratios(cells, unreachable)[0] == doctest::Approx(0.25));
  CHECK(ratios(cells, unreachable)[1] == doctest::Approx(0.25));
  CHECK(unreachable.error == doctest::Approx(0.25 * std::sqrt(30 * 1e-4 + 10 * 9e-3)));
  const auto few = wanted_sizes(cells, {.dim = 2, .target = 1e-9, .most_cells = 100});
  CHECK(few.cells == doctest::Approx(100));
  CHECK(ratios(cells, few)[1] < ratios(cells, few)[0]);
  const auto coarse = wanted_sizes(cells, {.dim = 2, .target = 1e9, .most_cells = 1e9});
  CHECK(ratios(cells, coarse)[0] == doctest::Approx(2.0));
  CHECK(wanted_sizes({}, {.dim = 2, .target = 0.1, .most_cells = 100}).samples.empty());
}

TEST_CASE("mesh sizes: cells of all ranks with places, edges and rates") {
  // A unit square in 2 x 4 x 4 right triangles; a unit cube in 6 tetrahedra a cell.
  for (const auto& [type, size] :
       {std::pair{ElementType::Triangle3, 32.0}, std::pair{ElementType::Tetrahedron4, 48.0}}) {
    const int divisions = type == ElementType::Triangle3 ? 4 : 2;
    const Mesh mesh =
        box_mesh(PETSC_COMM_WORLD, type, {divisions, divisions, divisions}, [](auto p) -> std::array<double, 3> {
          return {p[0], p[1], p[2]};
        });
    std::size_t count = 0;
    for (const auto& block : mesh.blocks)
      count += static_cast<std::size_t>(block.size());
    const std::vector<double> squares(count, 0.5);
    const auto cells = simplex_errors(mesh, squares, std::vector<std::uint8_t>(count, 1));
    int rank = 0;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank > 0) {
      CHECK(cells.empty());
      continue;
    }
    CHECK(double(cells.size()) == size);
    double volume = 0.0;
    for (const auto& cell : cells) {
      volume += mesh.dim == 2 ? std::sqrt(3.0) / 4.0 * std::pow(cell.edge, 2)
                              : std::pow(cell.edge, 3) / (6.0 * std::sqrt(2.0));
      CHECK(cell.square == 0.5);
      CHECK(cell.rate == 1.0); // of linear elements, also at the edge of contact
      CHECK(cell.place[0] > 0.0);
      CHECK(cell.place[0] < 1.0);
    }
    CHECK(volume == doctest::Approx(1.0));
  }
}

TEST_CASE("sequence error: that of a sequence of first order, and on the safe side of one of second order") {
  const std::vector<double> e = {0.4, 0.2, 0.1, 0.05};
  std::vector<double> first, second;
  for (const double error : e) {
    first.push_back(3.0 + 0.7 * error);
    second.push_back(3.0 - 0.7 * error * error);
  }
  CHECK(*sequence_error(first, e) == doctest::Approx(0.7 * 0.05 / first.back()));
  // s = 1 taken for s = 2: (1 - ρ²) / ρ² instead of (1 - ρ) / ρ, three times too much; the step before counts for two
  // times more.
  CHECK(*sequence_error(second, e) == doctest::Approx(6.0 * 0.7 * 0.05 * 0.05 / second.back()));
}

TEST_CASE("sequence error: too few meshes, nothing to be relative to, and values that agree by chance") {
  const std::vector<double> e = {0.4, 0.2, 0.1};
  CHECK_FALSE(sequence_error(std::vector{1.0, 2.0}, std::span(e).first(2)));
  CHECK_FALSE(sequence_error(std::vector{1.0, 2.0, 0.0}, e));
  CHECK(*sequence_error(std::vector{1.0, 2.0, 2.0}, e) == doctest::Approx(0.25));
  // Meshes that hardly differ: the change counts four times.
  CHECK(*sequence_error(std::vector{1.0, 1.0, 1.1}, std::vector{0.4, 0.2, 0.2}) == doctest::Approx(0.4 / 1.1));
}
