// `vi` on shipped scenes, made small: one increment with the whole load, from wrong first guesses of what touches. The
// problem is convex, so there is one answer, and the active set must find it from anywhere.
#include "base/error.hpp"
#include "scene.hpp"
#include "solve/bounded_newton.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace amontons;

namespace {

struct Replacement {
  std::string from, to;
};

/// A deck of inputs/ with every occurrence of some texts replaced.
std::unique_ptr<Scene> small_scene(const std::string& name, const std::vector<Replacement>& replacements) {
  const std::string folder = std::string(AMONTONS_SOURCE_DIR) + "/inputs/" + name + "/";
  std::ostringstream text;
  text << std::ifstream(folder + name + ".yaml").rdbuf();
  std::string deck = text.str();
  auto all = replacements;
  all.push_back({"file: ", "file: " + folder});
  for (const auto& [from, to] : all) {
    REQUIRE(deck.find(from) != std::string::npos);
    for (std::size_t at = 0; (at = deck.find(from, at)) != std::string::npos; at += to.size())
      deck.replace(at, from.size(), to);
  }
  const auto path = std::filesystem::temp_directory_path() / "amontons_first_guess_test.yaml";
  on_root(PETSC_COMM_WORLD, [&] { std::ofstream(path) << deck; });
  auto scene = build_scene(PETSC_COMM_WORLD, read_deck(PETSC_COMM_WORLD, path.string()));
  on_root(PETSC_COMM_WORLD, [&] { std::filesystem::remove(path); });
  return scene;
}

enum class Guess { Zero, AllTouch, NoneTouches, Random };

/// The state in which all bounded nodes are on their bounds, all of them `distance` above, or each anywhere between
/// `distance` below and above.
void guess(Guess kind, double distance, const Scene& scene, Vec u) {
  if (kind == Guess::Zero) return;
  const auto changed = scene.layout->new_vector();
  MatMult(scene.bounds->inverse(), u, changed);
  {
    VecArray values(changed);
    VecReader lower(scene.bounds->lower());
    for (PetscInt i = 0; i < values.size(); ++i) {
      if (lower[i] <= PETSC_NINFINITY) continue;
      const auto key = scene.mesh.keys[static_cast<std::size_t>(i / scene.mesh.dim)];
      const double above = kind == Guess::AllTouch      ? 0.0
                           : kind == Guess::NoneTouches ? 1.0
                                                        : double(key % 2001) / 1000.0 - 1.0;
      values[i] = lower[i] + distance * above;
    }
  }
  MatMult(scene.bounds->transform(), changed, u);
}

double largest(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_INFINITY, &value);
  return value;
}

/// PETSc options of one scene do not reach the next.
struct OptionScope {
  OptionScope() {
    PetscOptions fresh = nullptr;
    PetscOptionsCreate(&fresh);
    PetscOptionsPush(fresh);
  }
  ~OptionScope() { PetscOptionsPop(); }
  OptionScope(const OptionScope&) = delete;
  OptionScope& operator=(const OptionScope&) = delete;
};

/// Nodal pressures of all pairs on this rank.
std::vector<double> pressures(const Scene& scene) {
  std::vector<double> all;
  for (const auto* pair : scene.contacts) {
    const auto multipliers = pair->multipliers();
    all.insert(all.end(), multipliers.begin(), multipliers.end());
  }
  return all;
}

/// Pressures must agree, and displacements where no body can turn in its place as a disc without friction can.
void check_guesses(Scene& scene, double distance) {
  const OptionScope scope;
  choose_bounded_solver(*scene.problem);
  const auto reference = scene.layout->new_vector(), u = scene.layout->new_vector();
  std::vector<double> expected;
  for (const Guess kind : {Guess::Zero, Guess::AllTouch, Guess::NoneTouches, Guess::Random}) {
    CAPTURE(int(kind));
    BoundedNewton newton(*scene.problem, *scene.bounds, nullptr);
    scene.problem->roll_back();
    VecSet(u, 0.0);
    guess(kind, distance, scene, u);
    scene.problem->begin_increment(1.0, u);
    const auto outcome = newton.solve(u);
    CAPTURE(outcome.reason);
    CHECK(outcome.converged);
    CHECK(outcome.newton <= 15);
    const auto found = pressures(scene);
    if (kind == Guess::Zero) {
      VecCopy(u, reference);
      expected = found;
    }
    double difference = 0.0, peak = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      difference = std::max(difference, std::abs(found[i] - expected[i]));
      peak = std::max(peak, std::abs(expected[i]));
    }
    MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    CHECK(peak > 0.0);
    CHECK(difference < 1e-7 * peak);
    VecAXPY(u, -1.0, reference);
    if (scene.floating.empty()) CHECK(largest(u) < 1e-8 * largest(reference));
  }
}

const Replacement vi{"enforce: {semismooth: {}}", "enforce: {vi: {}}"};

} // namespace

TEST_CASE("signorini_block finds its edge of contact from any guess") {
  check_guesses(*small_scene("signorini_block", {{"n: 32", "n: 16"}}), 2e-3);
}

TEST_CASE("obstacle_ball finds its free boundary from any guess") {
  check_guesses(*small_scene("obstacle_ball", {{"n: 16", "n: 8"}}), 5e-3);
}

TEST_CASE("hertz_2d finds its contact from any guess") {
  check_guesses(*small_scene("hertz_2d", {vi, {"h: 0.05", "h: 0.2"}}), 0.02);
}

TEST_CASE("hertz_3d finds its contact from any guess") {
  check_guesses(*small_scene("hertz_3d", {vi, {"n: 9", "n: 3"}}), 0.02);
}

TEST_CASE("disc_stack, twelve bodies held by contact alone, finds its contacts from any guess") {
  const Replacement pairs{"slave: ", "enforce: {vi: {}}, slave: "};
  check_guesses(*small_scene("disc_stack", {pairs, {"R: 10,", "R: 10, h: 0.8,"}}), 0.05);
}
