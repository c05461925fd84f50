#include "output/key_match.hpp"

#include <numeric>
#include <unordered_map>

namespace amontons {

namespace {

using Parcels = std::vector<std::vector<std::uint64_t>>; // one per rank

/// Where each rank's part begins when parts of these sizes lie one after the other.
std::vector<int> offsets_of(const std::vector<int>& sizes) {
  std::vector<int> offsets(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), offsets.begin(), 0);
  return offsets;
}

/// What every rank has sent to this one.
Parcels exchange(MPI_Comm comm, const Parcels& sent) {
  std::vector<std::uint64_t> packed;
  std::vector<int> sent_sizes;
  for (const auto& parcel : sent) {
    sent_sizes.push_back(static_cast<int>(parcel.size()));
    packed.insert(packed.end(), parcel.begin(), parcel.end());
  }
  std::vector<int> got_sizes(sent.size());
  MPI_Alltoall(sent_sizes.data(), 1, MPI_INT, got_sizes.data(), 1, MPI_INT, comm);
  const auto sent_offsets = offsets_of(sent_sizes), got_offsets = offsets_of(got_sizes);
  std::vector<std::uint64_t> got(static_cast<std::size_t>(got_offsets.back() + got_sizes.back()));
  MPI_Alltoallv(packed.data(), sent_sizes.data(), sent_offsets.data(), MPI_UINT64_T, got.data(), got_sizes.data(),
                got_offsets.data(), MPI_UINT64_T, comm);
  Parcels parcels(sent.size());
  for (std::size_t rank = 0; rank < sent.size(); ++rank) {
    const auto begin = got.begin() + got_offsets[rank];
    parcels[rank].assign(begin, begin + got_sizes[rank]);
  }
  return parcels;
}

/// Keys may be regular numbers; a multiplication by 2^64 / golden ratio spreads them evenly over the ranks.
std::size_t home_of(std::uint64_t key, std::size_t ranks) { return ((key * 0x9E3779B97F4A7C15ull) >> 32) % ranks; }

constexpr std::uint64_t nowhere = ~std::uint64_t(0);

} // namespace

std::vector<std::int64_t> rows_of_keys(MPI_Comm comm, std::span<const std::uint64_t> table, std::int64_t first_row,
                                       std::span<const std::uint64_t> wanted) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  const auto ranks = static_cast<std::size_t>(size);

  Parcels offers(ranks), questions(ranks);
  for (std::size_t i = 0; i < table.size(); ++i) {
    auto& parcel = offers[home_of(table[i], ranks)];
    parcel.push_back(table[i]);
    parcel.push_back(static_cast<std::uint64_t>(first_row) + i);
  }
  for (const auto key : wanted)
    questions[home_of(key, ranks)].push_back(key);

  std::unordered_map<std::uint64_t, std::uint64_t> row_of;
  for (const auto& parcel : exchange(comm, offers))
    for (std::size_t i = 0; i < parcel.size(); i += 2)
      row_of.emplace(parcel[i], parcel[i + 1]);

  Parcels answers = exchange(comm, questions);
  for (auto& parcel : answers)
    for (auto& key : parcel) {
      const auto found = row_of.find(key);
      key = found == row_of.end() ? nowhere : found->second;
    }
  answers = exchange(comm, answers);

  // Answers of a rank come in the order of the questions to it.
  std::vector<std::size_t> next(ranks, 0);
  std::vector<std::int64_t> rows;
  rows.reserve(wanted.size());
  for (const auto key : wanted) {
    const std::size_t home = home_of(key, ranks);
    const std::uint64_t row = answers[home][next[home]++];
    rows.push_back(row == nowhere ? -1 : static_cast<std::int64_t>(row));
  }
  return rows;
}

} // namespace amontons
