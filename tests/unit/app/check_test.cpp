// What `amontons check` says of a deck without solving it.
#include "check.hpp"
#include "deck.hpp"
#include "deck/shape.hpp"

#include <doctest/doctest.h>
#include <petscsys.h>

using namespace amontons;

TEST_CASE("check counts the memory of the solver that would be chosen") {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const auto folder = std::string(AMONTONS_SOURCE_DIR) + "/inputs/press_and_slide_3d/";
  const auto small = check_report(PETSC_COMM_WORLD, folder + "press_and_slide_3d.yaml");
  const auto large = check_report(PETSC_COMM_WORLD, folder + "press_and_slide_3d_large.yaml");
  if (rank > 0) return;
  CHECK(small.find("with the direct solver") != std::string::npos);
  CHECK(small.find("with multigrid") == std::string::npos);
  CHECK(large.find("with multigrid") != std::string::npos);
}

TEST_CASE("check and the manual say which formulation to choose") {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const auto report =
      check_report(PETSC_COMM_WORLD, std::string(AMONTONS_SOURCE_DIR) + "/inputs/hertz_2d/hertz_2d.yaml");
  for (const char* formulation : {"semismooth", "basis: dual", "vi", "uzawa", "penalty"})
    CHECK(enforce_advice().find(formulation) != std::string::npos);
  CHECK(manual_page(deck_shape(), "contact.enforce").find("saddle point") != std::string::npos);
  if (rank == 0) CHECK(report.find(enforce_advice()) != std::string::npos);
}
