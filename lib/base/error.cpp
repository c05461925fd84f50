#include "base/error.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>

namespace amontons {

namespace {

std::string joined_lines(const std::vector<std::string>& messages) {
  std::string text;
  for (const auto& message : messages)
    text += (text.empty() ? "" : "\n") + message;
  return text;
}

/// One string for all messages and back: '\0' between them.
std::string packed(const std::vector<std::string>& messages) {
  std::string text;
  for (const auto& message : messages)
    text += message + '\0';
  return text;
}

std::vector<std::string> unpacked(const std::string& text) {
  std::vector<std::string> messages;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = text.find('\0', begin);
    messages.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return messages;
}

} // namespace

UserError::UserError(std::string message) : UserError(std::vector<std::string>{std::move(message)}) {}

UserError::UserError(std::vector<std::string> messages)
    : std::runtime_error(joined_lines(messages)), messages_(std::move(messages)) {}

void on_root(MPI_Comm comm, const std::function<void()>& work) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  together(comm, [&] {
    if (rank == 0) work();
  });
}

void together(MPI_Comm comm, const std::function<void()>& work) {
  std::string mine;
  try {
    work();
  } catch (const UserError& error) {
    mine = packed(error.messages());
  }
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  const int length = static_cast<int>(mine.size());
  std::vector<int> lengths(ranks);
  MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, comm);
  std::vector<int> offsets(ranks + 1, 0);
  for (int rank = 0; rank < ranks; ++rank)
    offsets[rank + 1] = offsets[rank] + lengths[rank];
  if (offsets[ranks] == 0) return;
  std::string all(offsets[ranks], ' ');
  MPI_Allgatherv(mine.data(), length, MPI_CHAR, all.data(), lengths.data(), offsets.data(), MPI_CHAR, comm);
  std::vector<std::string> messages;
  std::set<std::string> seen;
  for (auto& message : unpacked(all))
    if (seen.insert(message).second) messages.push_back(message);
  throw UserError(std::move(messages));
}

std::string nearest_match(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j)
      row[j] = j;
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substitution = diagonal + (word[i - 1] != candidate[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

std::string join_names(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

} // namespace amontons
