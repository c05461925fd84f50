#include "output/history.hpp"

#include "base/error.hpp"
#include "output/text_file.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

namespace amontons {

namespace {

/// A comma, quote or line end in a name (contact pairs are named by the user) would shift the columns.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string cell = "\"";
  for (const char c : name) {
    if (c == '"') cell += '"';
    cell += c == '\n' || c == '\r' ? ' ' : c;
  }
  cell += '"';
  return cell;
}

std::string header_line(const std::vector<std::string>& columns) {
  std::string line;
  for (const auto& column : columns) {
    if (!line.empty()) line += ',';
    line += quoted(column);
  }
  return line;
}

/// The rows of an earlier run up to and including `time`. A last row without its line end was cut by a crash.
std::string rows_until(const std::string& path, const std::string& header, double time) {
  std::istringstream lines(read_text(path, "the history"));
  std::string line;
  std::getline(lines, line);
  if (line != header)
    throw UserError("The history " + path +
                    " has other columns than this deck writes, so that a restart cannot go on with it. "
                    "Restart into another directory with --out.");
  const double last = time + 1e-9 * std::abs(time);
  std::string kept = header + '\n';
  while (std::getline(lines, line) && !lines.eof()) {
    double row_time = 0.0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), row_time);
    if (error == std::errc() && row_time <= last) kept += line + '\n';
  }
  return kept;
}

} // namespace

HistoryWriter::HistoryWriter(MPI_Comm comm, const std::string& path, std::vector<std::string> columns,
                             std::optional<double> resume_time)
    : columns_(std::move(columns)) {
  on_root(comm, [&] {
    const std::string header = header_line(columns_);
    const bool resumes = resume_time && std::filesystem::exists(path);
    write_atomically(path, resumes ? rows_until(path, header, *resume_time) : header + '\n');
    file_.reset(std::fopen(path.c_str(), "a"));
    if (!file_) throw UserError("The history " + path + " cannot be written: " + std::strerror(errno) + ".");
  });
}

void HistoryWriter::row(std::span<const double> values) {
  if (values.size() != columns_.size())
    throw std::logic_error("a history row has " + std::to_string(values.size()) + " values for " +
                           std::to_string(columns_.size()) + " columns");
  if (!file_) return;
  std::string line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, values[i]);
    if (i > 0) line += ',';
    line.append(digits, end);
  }
  line += '\n';
  std::fwrite(line.data(), 1, line.size(), file_.get());
  std::fflush(file_.get());
}

} // namespace amontons
