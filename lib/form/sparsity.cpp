#include "form/sparsity.hpp"

#include <algorithm>

namespace amontons {

Sparsity::Sparsity(const DofLayout& layout) : layout_(layout), rows_(layout.num_owned_blocks()) {
  // Every block couples to itself: prescribed and idle equations keep a diagonal.
  for (PetscInt b = 0; b < layout.num_owned_blocks(); ++b)
    rows_[b].push_back(layout.first_block() + b);
}

void Sparsity::add(std::span<const PetscInt> equations) {
  blocks_.clear();
  PetscInt last = -1;
  for (const PetscInt equation : equations) {
    const PetscInt block = layout_.block_of(equation);
    if (block != last) blocks_.push_back(block);
    last = block;
  }
  std::sort(blocks_.begin(), blocks_.end());
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
  const PetscInt first = layout_.first_block(), end = first + layout_.num_owned_blocks();
  for (const PetscInt block : blocks_)
    insert(block >= first && block < end ? rows_[block - first] : foreign_[block], blocks_);
}

void Sparsity::insert(Row& row, const std::vector<PetscInt>& blocks) {
  if (std::includes(row.begin(), row.end(), blocks.begin(), blocks.end())) return;
  merged_.clear();
  std::set_union(row.begin(), row.end(), blocks.begin(), blocks.end(), std::back_inserter(merged_));
  row.assign(merged_.begin(), merged_.end());
}

std::vector<PetscInt> Sparsity::foreign_equations() const {
  std::vector<PetscInt> equations;
  for (const auto& [block, row] : foreign_)
    for (PetscInt i = 0; i < layout_.block_size(block); ++i)
      equations.push_back(layout_.block_begin(block) + i);
  std::sort(equations.begin(), equations.end());
  return equations;
}

void Sparsity::exchange() {
  const MPI_Comm comm = layout_.mesh().comm;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  // A message is a sequence of (row block, number of columns, column blocks ...).
  std::vector<std::vector<PetscInt>> messages(ranks);
  for (const auto& [block, row] : foreign_) {
    auto& message = messages[layout_.block_owner(block)];
    message.push_back(block);
    message.push_back(static_cast<PetscInt>(row.size()));
    message.insert(message.end(), row.begin(), row.end());
  }
  std::vector<int> send_counts(ranks), receive_counts(ranks), send_offsets(ranks + 1, 0), receive_offsets(ranks + 1, 0);
  for (int rank = 0; rank < ranks; ++rank)
    send_counts[rank] = static_cast<int>(messages[rank].size());
  MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm);
  std::vector<PetscInt> outgoing;
  for (int rank = 0; rank < ranks; ++rank) {
    outgoing.insert(outgoing.end(), messages[rank].begin(), messages[rank].end());
    send_offsets[rank + 1] = send_offsets[rank] + send_counts[rank];
    receive_offsets[rank + 1] = receive_offsets[rank] + receive_counts[rank];
  }
  std::vector<PetscInt> incoming(receive_offsets[ranks]);
  MPI_Alltoallv(outgoing.data(), send_counts.data(), send_offsets.data(), MPIU_INT, incoming.data(),
                receive_counts.data(), receive_offsets.data(), MPIU_INT, comm);
  for (std::size_t at = 0; at < incoming.size();) {
    const PetscInt block = incoming[at];
    const PetscInt columns = incoming[at + 1];
    const auto begin = incoming.begin() + static_cast<std::ptrdiff_t>(at) + 2;
    insert(rows_[block - layout_.first_block()], std::vector<PetscInt>(begin, begin + columns));
    at += 2 + std::size_t(columns);
  }
  foreign_.clear();
}

void Sparsity::preallocate(Mat matrix) {
  exchange();
  const PetscInt first = layout_.first_block(), end = first + layout_.num_owned_blocks();
  std::vector<PetscInt> on_rank(layout_.num_owned()), off_rank(layout_.num_owned());
  for (PetscInt b = 0; b < layout_.num_owned_blocks(); ++b) {
    PetscInt inside = 0, outside = 0;
    for (const PetscInt column : rows_[b])
      (column >= first && column < end ? inside : outside) += layout_.block_size(column);
    const PetscInt begin = layout_.block_begin(first + b) - layout_.first_equation();
    for (PetscInt i = 0; i < layout_.block_size(first + b); ++i) {
      on_rank[begin + i] = inside;
      off_rank[begin + i] = outside;
    }
  }
  AMT_PETSC(MatSeqAIJSetPreallocation(matrix, 0, on_rank.data()));
  AMT_PETSC(MatMPIAIJSetPreallocation(matrix, 0, on_rank.data(), 0, off_rank.data()));
  rows_.clear();
}

} // namespace amontons
