// Mutated decks: each is read or refused with a UserError, nothing else.
#include "base/error.hpp"
#include "deck.hpp"
#include "mutations.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using namespace amontons;

namespace {

std::vector<std::string> shipped_decks() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(AMONTONS_SOURCE_DIR "/inputs"))
    if (entry.path().extension() == ".yaml" && entry.path().stem().extension().empty()) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const auto& path : paths) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    texts.push_back(text.str());
  }
  return texts;
}

} // namespace

TEST_CASE("a mutated deck is read or refused, and a refusal says what is wrong") {
  const auto decks = shipped_decks();
  REQUIRE(decks.size() >= 15);
  const int count = test::mutation_count(300);
  test::Mutations mutations({"-1", "0", "1e308", "nan", "inf", "99999999999999999999", "{}", "[]", "[", "~", "''", "\n",
                             "x", "t/0", "&a", "*a", "<<", "!!"});
  int read = 0, refused = 0;
  for (int i = 0; i < count; ++i) {
    const auto text = mutations.mutate(decks[static_cast<std::size_t>(i) % decks.size()]);
    try {
      parse_deck(text, "mutated.yaml", false);
      ++read;
    } catch (const UserError& error) {
      ++refused;
      if (std::string(error.what()).find("mutated.yaml") == std::string::npos) {
        CAPTURE(text);
        CAPTURE(std::string(error.what()));
        FAIL_CHECK("the message does not say where");
      }
    } catch (const std::exception& error) {
      CAPTURE(text);
      CAPTURE(std::string(error.what()));
      FAIL_CHECK("another exception than UserError");
    }
  }
  CHECK(read + refused == count);
  CHECK(refused > count / 10);
}
