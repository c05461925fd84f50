// Decks with bytes cut, doubled, flipped and words exchanged: each is read or refused with a UserError, nothing else.
// The environment variable AMONTONS_MUTATIONS says how many (300 without it); the seed is fixed.
#include "base/error.hpp"
#include "deck.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <random>
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

class Mutations {
 public:
  std::string mutate(std::string text) {
    for (int i = below(3); i >= 0; --i)
      once(text);
    return text;
  }

 private:
  int below(std::size_t bound) { return static_cast<int>(engine_() % bound); }
  void once(std::string& text) {
    if (text.empty()) return;
    const auto at = static_cast<std::size_t>(below(text.size()));
    const std::size_t count = std::min(text.size() - at, static_cast<std::size_t>(1 + below(40)));
    switch (below(5)) {
    case 0:
      text.erase(at, count);
      break;
    case 1:
      text.insert(at, text.substr(at, count));
      break;
    case 2:
      text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
      break;
    case 3:
      if (below(3) == 0) text.resize(at);
      break;
    default: {
      static constexpr std::array words = {"-1", "0",   "1e308", "nan", "inf", "99999999999999999999",
                                           "{}", "[]",  "[",     "~",   "''",  "\n",
                                           "x",  "t/0", "&a",    "*a",  "<<",  "!!"};
      const auto begin = text.find_first_of(" :,", at);
      if (begin == std::string::npos) return;
      const auto end = std::min(text.find_first_of(" :,\n", begin + 1), text.size());
      text.replace(begin + 1, end - begin - 1, words[static_cast<std::size_t>(below(words.size()))]);
    }
    }
  }
  std::mt19937 engine_{20}; // its sequence is the same everywhere, unlike that of the standard's distributions
};

} // namespace

TEST_CASE("a mutated deck is read or refused, and a refusal says what is wrong") {
  const auto decks = shipped_decks();
  REQUIRE(decks.size() >= 15);
  const char* wanted = std::getenv("AMONTONS_MUTATIONS");
  const int count = wanted ? std::atoi(wanted) : 300;
  Mutations mutations;
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
