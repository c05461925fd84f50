// Boxes, and tree queries against looking at every box.
#include "geometry/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;

namespace {

std::vector<Box> random_boxes(int count, int dim, std::mt19937& random) {
  std::uniform_real_distribution<double> number(0.0, 1.0);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    std::array<double, 3> low{}, high{};
    for (int i = 0; i < dim; ++i) {
      low[i] = number(random);
      high[i] = low[i] + 0.1 * number(random);
    }
    box.include(std::span(low).first(dim));
    box.include(std::span(high).first(dim));
  }
  return boxes;
}

double distance(const Box& box, std::span<const double> point) {
  double sum = 0.0;
  for (std::size_t i = 0; i < point.size(); ++i)
    sum += std::pow(std::max({0.0, box.low[i] - point[i], point[i] - box.high[i]}), 2);
  return std::sqrt(sum);
}

} // namespace

TEST_CASE("Box: grows, inflates, meets") {
  Box box;
  CHECK(box.empty());
  CHECK(box.diagonal() == 0.0);
  box.inflate(1.0);
  CHECK(box.empty());
  box.include(std::array{1.0, 2.0});
  CHECK_FALSE(box.empty());
  CHECK(box.low[2] == 0.0);
  box.include(std::array{4.0, 6.0});
  CHECK(box.diagonal() == doctest::Approx(5.0));
  Box other;
  other.include(std::array{5.0, 6.0});
  CHECK_FALSE(box.meets(other));
  other.inflate(1.0); // now touches the corner (4, 6)
  CHECK(box.meets(other));
  CHECK_FALSE(box.meets(Box{}));
  Box all = box;
  all.include(Box{});
  CHECK(all.diagonal() == box.diagonal());
  all.include(other);
  CHECK(all.high[0] == doctest::Approx(6.0));
}

TEST_CASE("BoxTree: query and nearest agree with looking at every box") {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> number(-0.2, 1.2);
  for (const int dim : {2, 3}) {
    auto boxes = random_boxes(500, dim, random);
    boxes[17] = Box{}; // never found
    const BoxTree tree(boxes);
    std::vector<std::int32_t> found;
    for (int repeat = 0; repeat < 100; ++repeat) {
      std::array<double, 3> point{};
      for (int i = 0; i < dim; ++i)
        point[i] = number(random);
      Box around;
      around.include(std::span(point).first(dim));
      around.inflate(0.1);
      tree.query(around, found);
      std::vector<std::int32_t> expected;
      for (std::int32_t i = 0; i < 500; ++i)
        if (boxes[i].meets(around)) expected.push_back(i);
      CHECK(found == expected);
      tree.nearest(std::span(point).first(dim), 7, found);
      std::vector<double> all, chosen;
      for (const Box& box : boxes)
        if (!box.empty()) all.push_back(distance(box, std::span(point).first(dim)));
      for (const std::int32_t i : found)
        chosen.push_back(distance(boxes[i], std::span(point).first(dim)));
      std::sort(all.begin(), all.end());
      all.resize(7);
      REQUIRE(chosen.size() == 7);
      for (int i = 0; i < 7; ++i)
        CHECK(chosen[i] == doctest::Approx(all[i]));
    }
  }
}

TEST_CASE("BoxTree: empty trees find nothing, and trees move") {
  const BoxTree empty;
  std::vector<std::int32_t> found = {1, 2};
  Box box;
  box.include(std::array{0.0, 0.0, 0.0});
  empty.query(box, found);
  CHECK(found.empty());
  empty.nearest(std::array{0.0, 0.0, 0.0}, 3, found);
  CHECK(found.empty());
  BoxTree full(std::vector<Box>{box});
  BoxTree moved;
  moved = std::move(full);
  moved.query(box, found);
  CHECK(found == std::vector<std::int32_t>{0});
  moved.query(Box{}, found);
  CHECK(found.empty());
}
