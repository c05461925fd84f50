// The command line: which words are ours and which are PETSc's, and what each command does.
#pragma once

#include <mpi.h>
#include <string>
#include <vector>

namespace amontons {

/// A wrong deck, mesh or command line.
constexpr int status_wrong_input = 2;

struct SplitArguments {
  std::vector<std::string> own;   // for run_command, without the program's name
  std::vector<std::string> petsc; // options with a single dash, each followed by its value if it has one
};

/// Sorts the words after the program's name. What begins with one dash and a letter is a PETSc option; the word behind
/// it is its value unless it begins with a dash (a negative number is a value) or ends like a deck (.yaml, .yml).
SplitArguments split_arguments(const std::vector<std::string>& words);

/// Parses our part of the command line and carries it out; returns the exit status. Errors of the user are printed
/// once, by rank 0, to stderr. Collective.
int run_command(MPI_Comm comm, const SplitArguments& arguments);

} // namespace amontons
