// What the terminal shows, and the same in log.txt. Rank 0 speaks for all; the other ranks' calls do nothing.
#pragma once

#include <cstdio>
#include <memory>
#include <mpi.h>
#include <string>

namespace amontons {

/// Terminal and file log of a run. Lines given before open() go to the terminal at once and are kept for the file, so
/// that nothing in the results directory is touched before the deck has been checked.
class Log {
 public:
  explicit Log(MPI_Comm comm);

  /// Shows `text` (without trailing newline) and flushes, so that a killed run leaves a complete log. Not collective.
  void line(const std::string& text);

  /// From now on lines go to the file at `path` too, after those given so far. `append` keeps what the file holds (a
  /// restart). Throws UserError when the file cannot be written. Collective.
  void open(const std::string& path, bool append = false);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  MPI_Comm comm_;
  bool speaks_ = false;
  std::string kept_;
  std::unique_ptr<std::FILE, Close> file_;
};

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

} // namespace amontons
