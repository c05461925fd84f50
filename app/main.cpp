// The program: PETSc and MPI around one command.
#include "base/petsc.hpp"
#include "commands.hpp"
#include "hand_over.hpp"

#include <cstdlib>
#include <iostream>

namespace {

const char* const help =
    "Amontons: contact between deformable solids by finite elements. `amontons --help` shows how to "
    "call it; below are the options of PETSc.\n";

/// A fault of the program or of PETSc options. Other ranks may be waiting in a collective call: end them too.
int give_up(const std::exception& error) {
  std::cerr << "error: " << error.what() << std::endl;
  MPI_Abort(PETSC_COMM_WORLD, 1);
  return 1;
}

} // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "plan") return amontons::hand_over_to_script("plan", {argv + 2, argv + argc});
  // SCOTCH 7 orders with all cores and so differently at each run: the last digits of results would change. One thread
  // a rank gives the same bits each time.
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 0);
  const auto arguments = amontons::split_arguments({argv + 1, argv + argc});
  // PETSc sees its own words only: it would take a deck for the value of the flag before it.
  std::vector<std::string> words = arguments.petsc;
  words.insert(words.begin(), argv[0]);
  std::vector<char*> pointers;
  for (auto& word : words)
    pointers.push_back(word.data());
  int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  char** petsc_argv = pointers.data();
  if (PetscInitialize(&count, &petsc_argv, nullptr, help) != 0) return 1;
  int status = 0;
  try {
    status = amontons::run_command(PETSC_COMM_WORLD, arguments);
  } catch (const std::exception& error) {
    return give_up(error);
  }
  const auto code = PetscFinalize();
  return status != 0 || code == 0 ? status : 1;
}
