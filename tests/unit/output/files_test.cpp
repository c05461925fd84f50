// Log, results directory, history, summary: the text files of a run.
#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/log.hpp"
#include "output/history.hpp"
#include "output/results_directory.hpp"
#include "output/summary.hpp"
#include "output/text_file.hpp"
#include "scratch.hpp"

#include <csignal>
#include <doctest/doctest.h>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace amontons {
namespace {

namespace fs = std::filesystem;
const MPI_Comm world = MPI_COMM_WORLD;

/// Puts a small file there (rank 0), and waits.
void put(const std::string& path, const std::string& text) {
  if (world_rank() == 0) std::ofstream(path) << text;
  MPI_Barrier(world);
}

TEST_CASE("log.txt has the lines from before it was opened, and only rank 0's") {
  const Scratch scratch("log");
  const std::string path = scratch / "log.txt";
  {
    Log log(world);
    log.line("checked");
    CHECK_FALSE(fs::exists(path));
    MPI_Barrier(world);
    log.open(path);
    log.line(formatted("increment %d of %g %%", 3, 0.5));
  }
  MPI_Barrier(world);
  CHECK(read_text(path, "log") == "checked\nincrement 3 of 0.5 %\n");
  MPI_Barrier(world);
  {
    Log log(world);
    log.line("again");
    log.open(path, true);
  }
  CHECK(read_text(path, "log") == "checked\nincrement 3 of 0.5 %\nagain\n");
  Log log(world);
  CHECK_THROWS_AS(log.open(scratch / "missing/log.txt"), UserError);
}

TEST_CASE("a new run sets the earlier one aside as a whole and leaves the rest alone") {
  const Scratch scratch("directory");
  const std::string results = scratch / "deep/results";
  prepare_results_directory(world, results, false);
  CHECK(fs::is_directory(results));
  CHECK(fs::is_empty(results));
  MPI_Barrier(world);

  put(results + "/history.csv", "first");
  put(results + "/fields.h5", "first");
  put(results + "/mine.txt", "foreign");
  prepare_results_directory(world, results, false);
  CHECK_FALSE(fs::exists(results + "/history.csv"));
  CHECK_FALSE(fs::exists(results + "/fields.h5"));
  CHECK(read_text(results + "/previous/fields.h5", "file") == "first");
  CHECK(read_text(results + "/mine.txt", "file") == "foreign");
  MPI_Barrier(world);

  put(results + "/history.csv", "second");
  put(results + "/previous/notes.txt", "foreign");
  prepare_results_directory(world, results, true);
  CHECK(read_text(results + "/history.csv", "file") == "second"); // kept for a restart
  MPI_Barrier(world);
  prepare_results_directory(world, results, false);
  CHECK(read_text(results + "/previous/history.csv", "file") == "second");
  CHECK_FALSE(fs::exists(results + "/previous/fields.h5")); // of the first run: never a mixture of two
  CHECK(read_text(results + "/previous/notes.txt", "file") == "foreign");
}

TEST_CASE("a place that cannot be a results directory is refused on every rank, and nothing moves") {
  const Scratch scratch("refused");
  put(scratch / "file", "x");
  CHECK_THROWS_WITH_AS(prepare_results_directory(world, scratch / "file", false), doctest::Contains("--out"),
                       UserError);
  CHECK_THROWS_AS(prepare_results_directory(world, scratch / "file/below", false), UserError);
  put(scratch / "previous", "a file of the user's");
  put(scratch / "log.txt", "run");
  CHECK_THROWS_AS(prepare_results_directory(world, scratch.path(), false), UserError);
  CHECK(read_text(scratch / "log.txt", "file") == "run");
  CHECK(read_text(scratch / "previous", "file") == "a file of the user's");
}

TEST_CASE("a results directory whose earlier files cannot all move is left as it was") {
  const Scratch scratch("half");
  put(scratch / "fields.h5", "run");
  put(scratch / "log.txt", "run");
  // A directory with something in it stands where the second file would go.
  if (world_rank() == 0) fs::create_directories(scratch / "previous/log.txt/x");
  MPI_Barrier(world);
  CHECK_THROWS_AS(prepare_results_directory(world, scratch.path(), false), UserError);
  CHECK(read_text(scratch / "fields.h5", "file") == "run");
  CHECK(read_text(scratch / "log.txt", "file") == "run");
}

TEST_CASE("history rows read back exactly and a restart cuts the later ones") {
  const Scratch scratch("history");
  const std::string path = scratch / "history.csv";
  const double third = 1.0 / 3.0, tenths = 0.1 + 0.2;
  const std::vector<std::string> columns = {"time", "force", "pair \"a\", b"};
  {
    HistoryWriter history(world, path, columns);
    history.row(std::vector{0.1, third, 1e300});
    history.row(std::vector{tenths, -0.0, std::numeric_limits<double>::quiet_NaN()});
    history.row(std::vector{0.4, 2.0, 3.0});
    CHECK_THROWS_AS(history.row(std::vector{0.5}), std::logic_error);
  }
  put(scratch / "unused", ""); // waits for rank 0
  const std::string head = "time,force,\"pair \"\"a\"\", b\"\n";
  const std::string two_rows = "0.1,0.3333333333333333,1e+300\n0.30000000000000004,-0,nan\n";
  CHECK(read_text(path, "file") == head + two_rows + "0.4,2,3\n");
  CHECK(std::stod("0.3333333333333333") == third);
  MPI_Barrier(world);
  {
    HistoryWriter history(world, path, columns, 0.3);
    history.row(std::vector{0.35, 5.0, 6.0});
  }
  put(scratch / "unused", "");
  CHECK(read_text(path, "file") == head + two_rows + "0.35,5,6\n");
  MPI_Barrier(world);
  put(path, head + two_rows + "0.35,5"); // cut by a crash
  { const HistoryWriter history(world, path, columns, 9.0); }
  CHECK(read_text(path, "file") == head + two_rows);
  CHECK_THROWS_WITH_AS(HistoryWriter(world, path, {"time", "other"}, 0.3), doctest::Contains("other columns"),
                       UserError);
  CHECK(read_text(path, "file") == head + two_rows);
}

TEST_CASE("the summary keeps the order of its keys and replaces the old one") {
  const Scratch scratch("summary");
  nlohmann::ordered_json summary;
  summary["status"] = "solved";
  summary["a"] = std::numeric_limits<double>::infinity();
  write_summary(world, scratch / "summary.json", {{"old", 1}});
  write_summary(world, scratch / "summary.json", summary);
  const auto text = read_text(scratch / "summary.json", "summary");
  CHECK(text == "{\n  \"status\": \"solved\",\n  \"a\": null\n}\n");
  CHECK_FALSE(fs::exists(scratch / "summary.json.unfinished"));
  CHECK_THROWS_AS(write_summary(world, scratch / "none/summary.json", summary), UserError);
}

TEST_CASE("a signal to any rank is known to all, and the handlers before come back") {
  const auto before = std::signal(SIGTERM, SIG_IGN);
  {
    const InterruptScope scope;
    CHECK_FALSE(interrupted(world));
    if (world_rank() == world_size() - 1) std::raise(SIGTERM);
    CHECK(interrupted(world));
    CHECK(interrupted(world));
  }
  CHECK((std::signal(SIGTERM, before) == SIG_IGN));
  const InterruptScope scope;
  CHECK_FALSE(interrupted(world));
}

} // namespace
} // namespace amontons
