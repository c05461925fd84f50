#include "output/results_directory.hpp"

#include "base/error.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

namespace amontons {

namespace {

namespace fs = std::filesystem;

constexpr std::array run_files = {"fields.h5",     "fields.xdmf", "history.csv", "summary.json",
                                  "checkpoint.h5", "log.txt",     "failed.h5",   "failed.xdmf"};

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
  throw UserError("The results directory " + path.string() + " cannot be used: " + reason +
                  ". Choose another one with --out or `output: {directory: ...}`.");
}

/// Asking the file system is the only sure test: permission bits say little for root, on network and full disks.
void check_writable(const fs::path& path) {
  const fs::path probe = path / ".amontons_write_test";
  std::ofstream file(probe);
  file << "x";
  file.close();
  const bool written = bool(file);
  std::error_code ignored;
  fs::remove(probe, ignored);
  if (!written) refuse(path, "no file can be written there");
}

void set_aside(const fs::path& path) {
  std::vector<const char*> present;
  for (const char* name : run_files)
    if (fs::exists(path / name)) present.push_back(name);
  if (present.empty()) return;
  const fs::path previous = path / "previous";
  fs::create_directory(previous);
  for (const char* name : run_files)
    fs::remove(previous / name);
  std::vector<const char*> moved;
  try {
    for (const char* name : present) {
      fs::rename(path / name, previous / name);
      moved.push_back(name);
    }
  } catch (const fs::filesystem_error&) {
    std::error_code ignored;
    for (const char* name : moved)
      fs::rename(previous / name, path / name, ignored);
    throw;
  }
}

} // namespace

void prepare_results_directory(MPI_Comm comm, const std::string& path, bool keep) {
  on_root(comm, [&] {
    const fs::path directory = path;
    try {
      if (fs::exists(directory) && !fs::is_directory(directory)) refuse(directory, "a file has that name");
      fs::create_directories(directory);
      check_writable(directory);
      if (!keep) set_aside(directory);
    } catch (const fs::filesystem_error& error) {
      refuse(directory, error.code().message());
    }
  });
}

} // namespace amontons
