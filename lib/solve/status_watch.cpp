#include "solve/status_watch.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace amontons {

namespace {

/// FNV-1a by G. Fowler, L. C. Noll and K.-P. Vo.
constexpr std::uint64_t fnv_offset = 0xcbf29ce484222325ULL, fnv_prime = 0x100000001b3ULL;

/// The finalizer of splitmix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014): sums of FNV hashes as they are may
/// cancel between ranks, for one flipped bit changes them by plus or minus the same number.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

} // namespace

std::vector<WatchedPoints> watched(const std::vector<Switching*>& forms) {
  std::vector<WatchedPoints> points;
  for (const auto* form : forms)
    points.push_back({.name = form->switch_name(),
                      .branches = [form] { return form->branches(); },
                      .place = [form](std::size_t point) { return form->switch_place(point); }});
  return points;
}

StatusWatch::StatusWatch(MPI_Comm comm, std::vector<WatchedPoints> forms) : comm_(comm), forms_(std::move(forms)) {
  for (const auto& form : forms_)
    num_points_ += static_cast<std::int64_t>(form.branches().size());
  MPI_Allreduce(MPI_IN_PLACE, &num_points_, 1, MPI_INT64_T, MPI_SUM, comm_);
}

StatusWatch::Look StatusWatch::look() {
  if (!has_points()) return {0, 0.0};
  Branches now;
  for (const auto& form : forms_)
    now.push_back(form.branches());
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::uint64_t sums[2] = {fnv_offset + static_cast<std::uint64_t>(rank), 0};
  for (std::size_t form = 0; form < now.size(); ++form)
    for (std::size_t i = 0; i < now[form].size(); ++i) {
      sums[0] = (sums[0] ^ now[form][i]) * fnv_prime;
      if (!seen_.empty() && seen_.back()[form][i] != now[form][i]) ++sums[1];
    }
  sums[0] = mixed(sums[0]);
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UINT64_T, MPI_SUM, comm_);
  seen_.push_back(std::move(now));
  if (seen_.size() > most_looks) seen_.pop_front();
  return {sums[0], static_cast<double>(sums[1]) / static_cast<double>(num_points_)};
}

std::vector<std::vector<std::uint8_t>> StatusWatch::flipping(std::size_t looks, Flip flip) const {
  std::vector<std::vector<std::uint8_t>> marks;
  const auto kind = [flip](std::uint8_t branch) { return flip == Flip::OffOn ? std::uint8_t(branch != 0) : branch; };
  const std::size_t first = seen_.size() - std::min(looks, seen_.size());
  for (std::size_t form = 0; form < forms_.size(); ++form) {
    auto& mark = marks.emplace_back(forms_[form].branches().size(), std::uint8_t(0));
    for (std::size_t k = first + 1; k < seen_.size(); ++k)
      for (std::size_t i = 0; i < mark.size(); ++i)
        if (kind(seen_[k][form][i]) != kind(seen_[first][form][i])) mark[i] = 1;
  }
  return marks;
}

StatusWatch::Named StatusWatch::name(const std::vector<std::vector<std::uint8_t>>& marks, std::size_t most) const {
  std::vector<std::tuple<std::array<double, 3>, std::size_t>> mine; // place, form
  for (std::size_t form = 0; form < forms_.size(); ++form)
    for (std::size_t i = 0; i < marks[form].size(); ++i)
      if (marks[form][i]) mine.emplace_back(forms_[form].place(i), form);
  Named named{.count = static_cast<std::int64_t>(mine.size()), .first = {}};
  MPI_Allreduce(MPI_IN_PLACE, &named.count, 1, MPI_INT64_T, MPI_SUM, comm_);
  std::sort(mine.begin(), mine.end());
  mine.resize(std::min(most, mine.size()));
  std::vector<double> flat; // four numbers a point
  for (const auto& [place, form] : mine)
    flat.insert(flat.end(), {place[0], place[1], place[2], static_cast<double>(form)});
  int ranks = 1, size = static_cast<int>(flat.size());
  MPI_Comm_size(comm_, &ranks);
  std::vector<int> sizes(ranks), offsets(ranks);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm_);
  std::exclusive_scan(sizes.begin(), sizes.end(), offsets.begin(), 0);
  std::vector<double> all(std::size_t(offsets.back()) + sizes.back());
  MPI_Allgatherv(flat.data(), size, MPI_DOUBLE, all.data(), sizes.data(), offsets.data(), MPI_DOUBLE, comm_);
  for (std::size_t at = 0; at < all.size(); at += 4)
    named.first.push_back({forms_[static_cast<std::size_t>(all[at + 3])].name, {all[at], all[at + 1], all[at + 2]}});
  std::sort(named.first.begin(), named.first.end());
  named.first.resize(std::min(most, named.first.size()));
  return named;
}

} // namespace amontons
