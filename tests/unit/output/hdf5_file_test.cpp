#include "output/hdf5_file.hpp"

#include "base/error.hpp"
#include "scratch.hpp"

#include <doctest/doctest.h>

namespace amontons {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

/// Two rows of three numbers for each rank number below this one's, so that rank 0 has none.
std::vector<double> part() {
  std::vector<double> values;
  for (int i = 0; i < 6 * world_rank(); ++i)
    values.push_back(100.0 * world_rank() + i);
  return values;
}

TEST_CASE("parts of unequal size, empty ones and attributes come back") {
  const Scratch scratch("hdf5");
  const std::string path = scratch / "a.h5";
  Hdf5File out(world, path, FileUse::Create);
  out.write("/group/below/array", 3, part());
  out.write_attribute("/group", "text", std::string(""));
  out.write_attribute("/group/below", "text", std::string("two\nlines"));
  out.write_attribute("/group", "number", 1.0 / 3.0);
  out.write_attribute("/group", "count", std::int64_t(1) << 40);
  out.finish();
  Hdf5File more(world, path, FileUse::Append);
  more.write("/group/line", 1, std::vector<double>{double(world_rank())});
  more.finish();
  Hdf5File in(world, path, FileUse::Read);
  CHECK(in.read("/group/below/array", std::int64_t(part().size())) == part());
  CHECK(in.read("/group/line", 1) == std::vector<double>{double(world_rank())});
  CHECK(in.read_string("/group", "text").empty());
  CHECK(in.read_string("/group/below", "text") == "two\nlines");
  CHECK(in.read_double("/group", "number") == 1.0 / 3.0);
  CHECK(in.read_integer("/group", "count") == std::int64_t(1) << 40);
  CHECK(in.has_group("/group/below"));
  CHECK_FALSE(in.has_group("/other/below"));
  CHECK_NOTHROW(in.finish());
}

TEST_CASE("a failure is told to every rank at the end, and nobody waits for ever") {
  const Scratch scratch("hdf5_failure");
  Hdf5File out(world, scratch / "none/a.h5", FileUse::Create);
  out.write("/array", 3, part());
  out.write_attribute("/", "number", 1.0);
  CHECK_THROWS_WITH_AS(out.finish(), doctest::Contains("cannot be opened"), UserError);

  Hdf5File twice(world, scratch / "a.h5", FileUse::Create);
  twice.write("/array", 3, part());
  twice.write("/array", 3, part());
  CHECK_THROWS_WITH_AS(twice.finish(), doctest::Contains("the dataset /array cannot be made"), UserError);

  Hdf5File in(world, scratch / "a.h5", FileUse::Read);
  CHECK(in.read("/array", 7) == std::vector<double>(7, 0.0));
  CHECK(in.read_double("/", "number") == 0.0);
  CHECK_THROWS_WITH_AS(in.finish(), doctest::Contains("no dataset /array of the right size"), UserError);
}

} // namespace
} // namespace amontons
