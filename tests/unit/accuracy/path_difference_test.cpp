#include "accuracy/path_difference.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

namespace {

/// A pair with the same points on every rank: sums over ranks are `ranks` times those of one.
ContactSamples samples(std::vector<double> weight, std::vector<double> pressure, std::vector<double> shear) {
  ContactSamples result;
  const std::size_t n = weight.size();
  result.facet.assign(n, 0);
  result.normal.assign(n, {0.0, 1.0, 0.0});
  result.status.assign(n, ContactStatus::Stick);
  result.has_friction = true;
  for (std::size_t i = 0; i < n; ++i) {
    result.tau_c.push_back(0.5 * pressure[i]);
    result.shear.push_back({shear[i], 0.0, 0.0});
  }
  result.weight = std::move(weight);
  result.pressure = std::move(pressure);
  return result;
}

} // namespace

TEST_CASE("scales and differences are the norms that they say") {
  const std::vector<ContactSamples> a = {samples({1.0, 2.0}, {3.0, 4.0}, {0.5, 1.0})};
  std::vector<ContactSamples> b = {samples({1.0, 2.0}, {3.0, 4.5}, {0.5, 0.6})};
  const std::vector<double> moved = {0.0, 3.0, 4.0, 0.0}, other = {0.0, 3.1, 4.0, 0.0};
  const PathState one{2, moved, a}, two{2, other, b};
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const auto scales = path_scales(MPI_COMM_WORLD, one);
  CHECK(scales.displacement == doctest::Approx(4.0));
  REQUIRE(scales.pairs.size() == 1);
  CHECK(scales.pairs[0].pressure == doctest::Approx(std::sqrt(ranks * (9.0 + 32.0))));
  CHECK(scales.pairs[0].shear == doctest::Approx(0.5 * std::sqrt(ranks * (9.0 + 32.0))));
  CHECK(scales.pairs[0].traction == doctest::Approx(std::sqrt(17.0)));
  CHECK(scales.pairs[0].area == doctest::Approx(3.0 * ranks));

  const auto difference = path_difference(MPI_COMM_WORLD, one, two, scales);
  CHECK(difference.displacement == doctest::Approx(0.1 / 4.0));
  CHECK(difference.pressure == doctest::Approx(0.5 * std::sqrt(2.0 / 41.0)));
  CHECK(difference.shear == doctest::Approx(0.4 * std::sqrt(2.0 / 41.0) / 0.5));
  CHECK(difference.status == 0.0);
  CHECK(difference.largest() == difference.shear);
  const auto none = path_difference(MPI_COMM_WORLD, one, one, scales);
  CHECK(none.largest() == 0.0);
}

TEST_CASE("another status counts where the traction is another, too") {
  const std::vector<ContactSamples> a = {samples({1.0, 2.0, 1.0}, {10.0, 10.0, 10.0}, {1.0, 1.0, 1.0})};
  std::vector<ContactSamples> b = {samples({1.0, 2.0, 1.0}, {10.0, 10.0, 10.0}, {1.0, 1.05, 1.2})};
  b[0].status = {ContactStatus::Stick, ContactStatus::Slip, ContactStatus::Slip};
  const std::vector<double> still(4, 0.0);
  const PathState one{2, still, a}, two{2, still, b};
  const auto scales = path_scales(MPI_COMM_WORLD, one);
  // Largest traction 10.05: 0.05 is on the border, 0.2 is not.
  CHECK(path_difference(MPI_COMM_WORLD, one, two, scales).status == doctest::Approx(0.25));
}

TEST_CASE("scales keep the largest, pair by pair") {
  PathScales scales;
  scales.include({.displacement = 1.0, .pairs = {{.pressure = 2.0, .shear = 1.0, .traction = 3.0, .area = 1.0}}});
  scales.include({.displacement = 0.5, .pairs = {{.pressure = 3.0, .shear = 0.5, .traction = 1.0, .area = 2.0}}});
  CHECK(scales.displacement == 1.0);
  CHECK(scales.pairs[0].pressure == 3.0);
  CHECK(scales.pairs[0].shear == 1.0);
  CHECK(scales.pairs[0].traction == 3.0);
  CHECK(scales.pairs[0].area == 2.0);
}
