#include "base/log.hpp"

#include "base/error.hpp"

#include <cerrno>
#include <cstdarg>
#include <cstring>

namespace amontons {

Log::Log(MPI_Comm comm) : comm_(comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  speaks_ = rank == 0;
}

void Log::line(const std::string& text) {
  if (!speaks_) return;
  std::fprintf(stdout, "%s\n", text.c_str());
  std::fflush(stdout);
  if (file_) {
    std::fprintf(file_.get(), "%s\n", text.c_str());
    std::fflush(file_.get());
  } else {
    kept_ += text + '\n';
  }
}

void Log::open(const std::string& path, bool append) {
  on_root(comm_, [&] {
    file_.reset(std::fopen(path.c_str(), append ? "a" : "w"));
    if (!file_)
      throw UserError("The log " + path + " cannot be written: " + std::strerror(errno) +
                      ". Choose another directory with --out.");
    std::fputs(kept_.c_str(), file_.get());
    std::fflush(file_.get());
    kept_.clear();
  });
}

std::string formatted(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string text(length > 0 ? std::size_t(length) : 0, '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

} // namespace amontons
