// What is found out about a failed solve is said in words that name it.
#include "solve/trouble.hpp"

#include <doctest/doctest.h>

using namespace amontons;

namespace {

bool says(const Trouble& trouble, const char* words) { return in_words(trouble).find(words) != std::string::npos; }

} // namespace

TEST_CASE("too much changed at once is told from a quarter of the points on") {
  Trouble trouble;
  trouble.solver = "SNES gave up";
  CHECK(in_words(trouble) == "SNES gave up");
  trouble.largest_change = 0.24;
  CHECK(in_words(trouble) == "SNES gave up");
  trouble.largest_change = 0.6;
  CHECK(says(trouble, "up to 60 % of the contact points changed their status in one iteration"));
  CHECK(says(trouble, "the increment may be too large"));
}

TEST_CASE("bodies that nothing holds are named with their directions, flipping points with pair and place") {
  Trouble trouble;
  trouble.free = {{.body = "lid", .direction = "along x"}, {.body = "lid", .direction = "about z"}};
  CHECK(says(trouble, "nothing holds 'lid' along x, about z"));
  trouble.num_flipping = 5;
  trouble.points = {{.name = "joint", .place = {0.5, 0.25, 0.0}}};
  CHECK(says(trouble, "5 points flip: 'joint' at (0.5, 0.25, 0), ..."));
}
