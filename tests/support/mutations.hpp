// Texts with bytes cut, doubled, flipped and words exchanged, for tests of what reads files of users.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace amontons::test {

/// How many mutations a test tries: the environment variable AMONTONS_MUTATIONS, or so many without it.
inline int mutation_count(int otherwise) {
  const char* wanted = std::getenv("AMONTONS_MUTATIONS");
  return wanted ? std::atoi(wanted) : otherwise;
}

/// The first of them that is tried (AMONTONS_FIRST_MUTATION): several processes can share a long row, or go on with it.
inline int first_mutation() {
  const char* wanted = std::getenv("AMONTONS_FIRST_MUTATION");
  return wanted ? std::atoi(wanted) : 0;
}

class Mutations {
 public:
  /// `words`: what words of a text are exchanged for.
  explicit Mutations(std::vector<std::string> words) : words_(std::move(words)) {}

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
      const auto begin = text.find_first_of(" :,\n", at);
      if (begin == std::string::npos) return;
      const auto end = std::min(text.find_first_of(" :,\n", begin + 1), text.size());
      text.replace(begin + 1, end - begin - 1, words_[static_cast<std::size_t>(below(words_.size()))]);
    }
    }
  }
  std::vector<std::string> words_;
  std::mt19937 engine_{20}; // its sequence is the same everywhere, unlike that of the standard's distributions
};

} // namespace amontons::test
