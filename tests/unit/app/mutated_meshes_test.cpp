// Mutated meshes: each is read, checked against its deck and distributed, or refused with a UserError, nothing else.
#include "base/error.hpp"
#include "mutations.hpp"
#include "validate.hpp"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <petscsys.h>
#include <sstream>
#include <string>
#include <unistd.h>

using namespace amontons;
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A folder of this process's own, removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("amontons_meshes_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string write(const char* name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }

 private:
  fs::path path_;
};

const char* const deck = R"(
title: two blocks
mesh: {file: mesh.msh}
space: plane_strain
materials: {soft: {elastic: {E: 1000, nu: 0.3}}}
bodies: {lower: soft, upper: soft}
boundary:
  - {on: bottom, displacement: {x: 0, y: 0}}
  - {on: top, displacement: {x: 0, y: "-0.01*t"}}
contact:
  - {name: joint, slave: upper_bottom, master: lower_top, enforce: {semismooth: {}}}
steps: [{name: press, to: 1, increments: 1}]
)";

} // namespace

TEST_CASE("a mutated mesh is distributed or refused, and a refusal says which file or key is wrong") {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank != 0) return; // one process reads meshes
  const Folder folder;
  const auto path = folder.write("deck.yaml", deck);
  const auto sound = text_of(AMONTONS_SOURCE_DIR "/tests/refused/meshes/blocks.msh");
  REQUIRE(sound.size() > 100);
  test::Mutations mutations({"-1", "0", "1", "7", "1e308", "nan", "inf", "99999999999999999999", "2147483648", "x",
                             "\"\"", "$EndNodes", "$Elements", "\n"});
  const int count = test::mutation_count(100), first = test::first_mutation();
  int read = 0, refused = 0;
  for (int i = 0; i < count; ++i) {
    const auto text = i == 0 ? sound : mutations.mutate(sound);
    if (i > 0 && i < first) continue;
    folder.write("mesh.msh", text);
    try {
      const auto deck = read_deck(PETSC_COMM_SELF, path);
      distribute_mesh(PETSC_COMM_SELF, read_checked_mesh(PETSC_COMM_SELF, deck), contact_hints(deck), 0);
      ++read;
    } catch (const UserError& error) {
      ++refused;
      const std::string what = error.what();
      CAPTURE(what);
      CHECK((what.find("mesh.msh") != std::string::npos || what.find("deck.yaml") != std::string::npos));
    } catch (const std::exception& error) {
      CAPTURE(text_of(fs::path(path).parent_path() / "mesh.msh"));
      CAPTURE(std::string(error.what()));
      FAIL_CHECK("another exception than UserError");
    }
    REQUIRE((i > 0 || read == 1));
  }
  const int tried = first > 0 ? 1 + count - first : count; // the sound one in any case
  CHECK(read + refused == tried);
  CHECK(refused > tried / 4);
  MESSAGE("mutated meshes " << first << " to " << count - 1 << ": " << read << " distributed, " << refused
                            << " refused");
}
