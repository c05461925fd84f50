// Errors that a user can mend (wrong deck, wrong mesh) and how every rank learns of them together.
#pragma once

#include <functional>
#include <mpi.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace amontons {

/// The deck, the mesh or a command line is wrong: exit status 2. Holds all the messages found in one go, each a
/// complete sentence that says what, where, and what to do.
class UserError : public std::runtime_error {
 public:
  explicit UserError(std::string message);
  explicit UserError(std::vector<std::string> messages);
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  std::vector<std::string> messages_;
};

/// Runs `work` on rank 0 only. If it throws a UserError there, every rank throws that UserError. Collective.
void on_root(MPI_Comm comm, const std::function<void()>& work);

/// Runs `work` on every rank. If it throws a UserError on any rank, every rank throws a UserError with the messages of
/// all ranks, without repetitions. `work` must not contain collective calls. Collective.
void together(MPI_Comm comm, const std::function<void()>& work);

/// The candidate closest to `word` by edit distance, or an empty string when none is near.
std::string nearest_match(const std::string& word, const std::vector<std::string>& candidates);

/// "a, b and c".
std::string join_names(const std::vector<std::string>& names);

} // namespace amontons
