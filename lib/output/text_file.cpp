#include "output/text_file.hpp"

#include "base/error.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace amontons {

namespace {

[[noreturn]] void refuse(const std::string& path) {
  throw UserError("The file " + path + " cannot be written: " + std::strerror(errno) +
                  ". Make room or choose another directory with --out.");
}

} // namespace

void write_atomically(const std::string& path, const std::string& text) {
  const std::string unfinished = path + ".unfinished";
  errno = 0;
  std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) {
    const int reason = errno;
    std::remove(unfinished.c_str());
    errno = reason;
    refuse(path);
  }
  rename_synchronized(unfinished, path);
}

std::string read_text(const std::string& path, const std::string& what) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file) throw UserError("Cannot read " + what + " " + path + ": " + std::strerror(errno) + ".");
  return text.str();
}

void rename_synchronized(const std::string& from, const std::string& to) {
  const int file = open(from.c_str(), O_RDONLY);
  if (file < 0) refuse(to);
  const bool reached_disk = fsync(file) == 0;
  close(file);
  if (!reached_disk || std::rename(from.c_str(), to.c_str()) != 0) refuse(to);
}

} // namespace amontons
