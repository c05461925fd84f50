// history.csv: one row of named numbers per accepted increment, on disk as soon as it is known.
#pragma once

#include <cstdio>
#include <memory>
#include <mpi.h>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// Writes rows on rank 0; the other ranks' calls do nothing.
class HistoryWriter {
 public:
  /// Starts the file with a line of column names; the first column is the time. With `resume_time` (a restart) an
  /// existing file keeps its rows up to that time and is appended to. Throws UserError when the file cannot be written
  /// or an existing one to go on with has other columns. Collective.
  HistoryWriter(MPI_Comm comm, const std::string& path, std::vector<std::string> columns,
                std::optional<double> resume_time = {});

  /// One number per column, written with as many digits as reading back exactly needs. Not collective.
  void row(std::span<const double> values);

  const std::vector<std::string>& columns() const { return columns_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::vector<std::string> columns_;
  std::unique_ptr<std::FILE, Close> file_;
};

} // namespace amontons
