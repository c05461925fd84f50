#include "accuracy/worst.hpp"

#include <cstdio>

namespace amontons::accuracy {

Worst over_ranks(MPI_Comm comm, Worst mine) {
  struct {
    double value;
    int rank;
  } best{mine.value, 0};
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  best.rank = rank;
  MPI_Allreduce(MPI_IN_PLACE, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  int length = static_cast<int>(mine.where.size());
  MPI_Bcast(&length, 1, MPI_INT, best.rank, comm);
  mine.where.resize(length);
  MPI_Bcast(mine.where.data(), length, MPI_CHAR, best.rank, comm);
  mine.value = best.value;
  return mine;
}

std::string place_text(std::span<const double> place) {
  std::string text = "(";
  for (std::size_t i = 0; i < place.size(); ++i) {
    std::array<char, 32> number;
    std::snprintf(number.data(), number.size(), "%s%.6g", i == 0 ? "" : ", ", place[i]);
    text += number.data();
  }
  return text + ")";
}

} // namespace amontons::accuracy
