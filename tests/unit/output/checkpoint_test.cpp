#include "output/checkpoint.hpp"

#include "base/error.hpp"
#include "hand_mesh.hpp"
#include "output/key_match.hpp"
#include "output/text_file.hpp"
#include "scratch.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <fstream>

namespace amontons {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

/// Values that say at which node and component they belong, in all their digits.
NodalArray labelled(const Mesh& mesh, int components) {
  NodalArray array{components, {}};
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    for (int i = 0; i < components; ++i) {
      const auto place = mesh.position(node);
      array.values.push_back(std::sin(place[0] + 3.0 * place[1] + (mesh.dim == 3 ? 7.0 * place[2] : 0.0)) + i);
    }
  return array;
}

/// Rows that say to which facet they belong and which of its rows they are; every third facet has none.
FacetArray labelled_rows(const Mesh& mesh) {
  FacetArray array{.surface = "top", .components = 2, .rows = {}, .values = {}};
  const auto& top = mesh.surfaces.at("top");
  for (std::int32_t f = 0; f < top.size(); ++f) {
    double far = 0.0;
    for (const auto node : top.facet(f))
      far = std::max(far, 5.0 * mesh.position(node)[0] + (mesh.dim == 3 ? mesh.position(node)[1] : 0.0));
    array.rows.push_back(static_cast<int>(std::lround(10.0 * far)) % 3);
    for (int row = 0; row < array.rows.back(); ++row)
      array.values.insert(array.values.end(), {std::sin(far), double(row)});
  }
  return array;
}

Checkpoint sample(const Mesh& mesh) {
  Checkpoint checkpoint;
  checkpoint.time = 1.0 / 3.0;
  checkpoint.step = 2;
  checkpoint.increment = 17;
  checkpoint.next_increment = 0.01;
  checkpoint.global = {{"tied / forces", {1.0 / 7.0, -2.0, 1e300}}, {"none", {}}};
  checkpoint.nodal = {{"displacement", labelled(mesh, mesh.dim)}, {"multiplier: a/b", labelled(mesh, 1)}};
  checkpoint.facets = {{"history: a/b", labelled_rows(mesh)}};
  return checkpoint;
}

void check_equal(const Checkpoint& read, const Mesh& mesh) {
  const Checkpoint expected = sample(mesh);
  CHECK(read.time == expected.time);
  CHECK(read.step == expected.step);
  CHECK(read.increment == expected.increment);
  CHECK(read.next_increment == expected.next_increment);
  CHECK(read.global == expected.global);
  REQUIRE(read.nodal.size() == expected.nodal.size());
  for (const auto& [name, array] : expected.nodal) {
    REQUIRE(read.nodal.contains(name));
    CHECK(read.nodal.at(name).components == array.components);
    CHECK(read.nodal.at(name).values == array.values); // bit by bit
  }
  REQUIRE(read.facets.contains("history: a/b"));
  const auto &rows = read.facets.at("history: a/b"), &wanted = expected.facets.at("history: a/b");
  CHECK(rows.surface == wanted.surface);
  CHECK(rows.components == wanted.components);
  CHECK(rows.rows == wanted.rows);
  CHECK(rows.values == wanted.values);
}

TEST_CASE("a checkpoint comes back bit by bit under any partition") {
  const Scratch scratch("checkpoint");
  const std::string path = scratch / "checkpoint.h5";
  const int ranks = world_size();
  const std::vector<std::function<int(int)>> partitions = {
      [=](int c) { return c % ranks; },       // scattered
      [=](int c) { return (c / 3) % ranks; }, // in pieces
      [=](int) { return ranks - 1; },         // the other ranks have no nodes at all
      [](int) { return 0; }};
  for (const auto& written : partitions)
    for (const auto& read : partitions)
      for (const int dim : {2, 3})
        for (const int order : {1, 2}) {
          const HandMesh hand{dim, order, {4, 3, 2}, 2};
          const Mesh before = hand.distribute(world, written);
          write_checkpoint(before, path, "deck", sample(before));
          const Mesh after = hand.distribute(world, read);
          check_equal(read_checkpoint(after, path, "deck"), after);
        }
}

TEST_CASE("a checkpoint written by some of the ranks is read by all, and the other way round") {
  const Scratch scratch("checkpoint_ranks");
  const HandMesh hand{2, 2, {4, 3, 1}, 2};
  const int ranks = world_size();
  const Mesh on_all = hand.distribute(world, [=](int c) { return c % ranks; });
  const Mesh alone = hand.distribute(MPI_COMM_SELF, [](int) { return 0; });
  if (world_rank() == 0) write_checkpoint(alone, scratch / "by_one.h5", "deck", sample(alone));
  MPI_Barrier(world);
  check_equal(read_checkpoint(on_all, scratch / "by_one.h5", "deck"), on_all);
  write_checkpoint(on_all, scratch / "by_all.h5", "deck", sample(on_all));
  if (world_rank() == ranks - 1) check_equal(read_checkpoint(alone, scratch / "by_all.h5", "deck"), alone);
}

TEST_CASE("a checkpoint of another mesh or deck, or a broken one, is refused on every rank") {
  const Scratch scratch("checkpoint_refused");
  const std::string path = scratch / "checkpoint.h5";
  const auto to_first = [](int) { return 0; };
  const Mesh mesh = HandMesh{2, 1, {4, 2, 1}, 2}.distribute(world, to_first);
  write_checkpoint(mesh, path, "deck", sample(mesh));
  const Mesh finer = HandMesh{2, 1, {5, 2, 1}, 2}.distribute(world, to_first);
  CHECK_THROWS_WITH_AS(read_checkpoint(finer, path, "deck"), doctest::Contains("15 nodes and this one has 18"),
                       UserError);
  const Mesh turned = HandMesh{2, 1, {2, 4, 1}, 2}.distribute(world, to_first);
  CHECK_THROWS_WITH_AS(read_checkpoint(turned, path, "deck"), doctest::Contains("same number of nodes"), UserError);
  CHECK_THROWS_WITH_AS(read_checkpoint(mesh, path, "other deck"), doctest::Contains("another deck"), UserError);
  CHECK_THROWS_WITH_AS(read_checkpoint(mesh, scratch / "none.h5", "deck"), doctest::Contains("no such file"),
                       UserError);
  if (world_rank() == 0) std::ofstream(scratch / "text.h5") << "no HDF5";
  if (world_rank() == 0) {
    std::filesystem::copy_file(path, scratch / "cut.h5");
    std::filesystem::resize_file(scratch / "cut.h5", std::filesystem::file_size(path) / 2);
  }
  MPI_Barrier(world);
  CHECK_THROWS_WITH_AS(read_checkpoint(mesh, scratch / "text.h5", "deck"), doctest::Contains("damaged"), UserError);
  CHECK_THROWS_WITH_AS(read_checkpoint(mesh, scratch / "cut.h5", "deck"), doctest::Contains("damaged"), UserError);
}

TEST_CASE("a write that does not finish leaves the older checkpoint") {
  const Scratch scratch("checkpoint_unfinished");
  const std::string path = scratch / "checkpoint.h5";
  const Mesh mesh = HandMesh{}.distribute(world, [](int) { return 0; });
  write_checkpoint(mesh, path, "deck", sample(mesh));
  // What a killed writer leaves: half a file under the temporary name.
  if (world_rank() == 0) std::ofstream(path + ".unfinished") << "\x89HDF";
  MPI_Barrier(world);
  check_equal(read_checkpoint(mesh, path, "deck"), mesh);
  write_checkpoint(mesh, path, "deck", sample(mesh));
  CHECK_FALSE(std::filesystem::exists(path + ".unfinished"));
  CHECK_THROWS_AS(write_checkpoint(mesh, scratch / "none/checkpoint.h5", "deck", sample(mesh)), UserError);
}

TEST_CASE("keys are found wherever they are, and unknown ones are said to be nowhere") {
  const int rank = world_rank(), ranks = world_size();
  const std::int64_t rows = 101;
  const std::int64_t first = rows * rank / ranks, end = rows * (rank + 1) / ranks;
  std::vector<std::uint64_t> table;
  for (auto row = first; row < end; ++row)
    table.push_back(std::uint64_t(row * row) << 40);
  std::vector<std::uint64_t> wanted;
  std::vector<std::int64_t> expected;
  for (std::int64_t i = rank; i < 2 * rows; i += 3) {
    wanted.push_back(std::uint64_t(i * i) << 40);
    expected.push_back(i < rows ? i : -1);
  }
  CHECK(rows_of_keys(MPI_COMM_WORLD, table, first, wanted) == expected);
}

} // namespace
} // namespace amontons
