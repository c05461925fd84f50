// A checkpoint's friction histories find their points again, whatever the order of the points within their facets.
#include "base/error.hpp"
#include "restart.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

using namespace amontons;

namespace {

const char* const deck_text = R"(
mesh: {file: MESHES/blocks.msh}
space: plane_strain
materials: {soft: {elastic: {E: 1000, nu: 0.3}}}
bodies: {lower: soft, upper: soft}
boundary:
  - {on: bottom, displacement: {x: 0, y: 0}}
  - {on: top, displacement: {x: 0, y: "-0.01*t"}}
contact:
  - name: joint
    slave: upper_bottom
    master: lower_top
    friction: {slip_weakening: {mu_s: 0.4, mu_k: 0.2, D_c: 0.1}}
steps: [{name: press, to: 1}]
)";

std::unique_ptr<Scene> scene() {
  std::string text = deck_text;
  text.replace(text.find("MESHES"), 6, std::string(AMONTONS_SOURCE_DIR) + "/tests/refused/meshes");
  const auto path = std::filesystem::temp_directory_path() / "amontons_restart_test.yaml";
  on_root(PETSC_COMM_WORLD, [&] { std::ofstream(path) << text; });
  auto built = build_scene(PETSC_COMM_WORLD, read_deck(PETSC_COMM_WORLD, path.string()));
  on_root(PETSC_COMM_WORLD, [&] { std::filesystem::remove(path); });
  return built;
}

/// A history that tells points apart.
ContactHistory labelled(const PairReport& contact) {
  auto history = contact.accepted();
  history.time = 0.25;
  for (std::size_t i = 0; i < history.points.size(); ++i) {
    const double x = contact.points().points()[i].place[0];
    history.points[i] = {
        .traction = {x, 0, 0}, .jump = {2 * x, x * x, -x}, .state = {5 * x, 7 * x}, .slip = 1 + x, .open = x < 0.5};
  }
  for (std::size_t i = 0; i < history.multipliers.size(); ++i)
    history.multipliers[i] = -1.0;
  return history;
}

/// Every facet's rows the other way round.
void reverse_rows(FacetArray& array) {
  const auto components = static_cast<std::size_t>(array.components);
  std::vector<double> reversed;
  std::size_t first = 0;
  for (const auto rows : array.rows) {
    for (std::size_t row = first + rows; row-- > first;)
      reversed.insert(reversed.end(), array.values.begin() + static_cast<std::ptrdiff_t>(row * components),
                      array.values.begin() + static_cast<std::ptrdiff_t>((row + 1) * components));
    first += rows;
  }
  array.values = reversed;
}

std::vector<double> rows_of(const ContactHistory& history) {
  std::vector<double> rows;
  for (const auto& point : history.points)
    point.append_to(rows);
  return rows;
}

} // namespace

TEST_CASE("friction histories come back to their points, in whatever order a facet has them") {
  const auto written = scene(), read = scene();
  Ledger books(*written), other_books(*read);
  const auto history = labelled(*written->contacts[0]);
  written->contacts[0]->restore(history);
  written->problem->resume(0.25, 10.0);
  const auto unknowns = written->layout->new_vector(), restored = read->layout->new_vector();
  auto checkpoint = make_checkpoint(*written, books, unknowns);
  REQUIRE(checkpoint.facets.size() == 1);
  const auto straight = checkpoint.facets.begin()->second.values;
  reverse_rows(checkpoint.facets.begin()->second);
  std::int64_t sizes[2] = {static_cast<std::int64_t>(straight.size()),
                           straight == checkpoint.facets.begin()->second.values ? 0 : 1};
  MPI_Allreduce(MPI_IN_PLACE, sizes, 2, MPI_INT64_T, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(sizes[0] > 0);
  CHECK(sizes[1] > 0); // the order has changed on some rank
  restore_state(*read, other_books, checkpoint, restored);
  const auto back = read->contacts[0]->accepted();
  CHECK(rows_of(back) == rows_of(history));
  CHECK(back.multipliers == history.multipliers);
  CHECK(back.time == 0.25);
  CHECK(read->problem->time() == 0.25);
  CHECK(read->problem->largest_force() == 10.0);
}

TEST_CASE("histories of other points are refused on every rank") {
  const auto written = scene();
  Ledger books(*written);
  const auto unknowns = written->layout->new_vector();
  auto checkpoint = make_checkpoint(*written, books, unknowns);
  auto& array = checkpoint.facets.begin()->second;
  for (std::size_t i = 0; i < array.values.size(); i += static_cast<std::size_t>(array.components))
    array.values[i] += 0.01;
  CHECK_THROWS_WITH_AS(restore_state(*written, books, checkpoint, unknowns),
                       doctest::Contains("other quadrature points"), UserError);
}
