#include "mesh/geo_script.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace amontons {
namespace {

/// The text with comments blanked; strings stay, since a comment sign inside one is none.
std::string without_comments(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text[i] == '"') {
      end = text.find('"', i + 1);
      end = end == std::string::npos ? text.size() : end + 1;
      plain += text.substr(i, end - i);
    } else if (text.compare(i, 2, "//") == 0) {
      end = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      end = text.find("*/", i + 2);
      end = end == std::string::npos ? text.size() : end + 2;
      plain += ' ';
    } else {
      plain += text[i];
    }
    i = end;
  }
  return plain;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::size_t skip_blanks(const std::string& text, std::size_t at) {
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])))
    ++at;
  return at;
}

std::string word_at(const std::string& text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_word(text[end]))
    ++end;
  return text.substr(at, end - at);
}

/// Names at the start of the items of a bracketed list whose text begins at `at`: "h = 0.1, L = {1, Name "a,b"}]".
std::vector<std::string> listed_names(const std::string& text, std::size_t at) {
  std::vector<std::string> names;
  int depth = 0;
  bool in_string = false;
  bool item_begins = true;
  for (; at < text.size() && (depth > 0 || text[at] != ']' || in_string); ++at) {
    if (item_begins) {
      at = skip_blanks(text, at);
      if (const auto name = word_at(text, at); !name.empty()) names.push_back(name);
      item_begins = false;
      if (at >= text.size() || text[at] == ']') break;
    }
    const char c = text[at];
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if (c == '{' || c == '(' || c == '[') ++depth;
    if (c == '}' || c == ')' || c == ']') --depth;
    item_begins = depth == 0 && c == ',';
  }
  return names;
}

void collect(const std::filesystem::path& file, std::set<std::filesystem::path>& seen,
             std::vector<std::string>& names) {
  if (!seen.insert(file.lexically_normal()).second) return;
  std::ifstream stream(file);
  const std::string text = without_comments({std::istreambuf_iterator<char>(stream), {}});
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string word = word_at(text, i);
    if (word.empty()) continue;
    const std::size_t next = skip_blanks(text, i + word.size());
    const char sign = next < text.size() ? text[next] : ' ';
    if (word == "DefineConstant" && sign == '[') {
      for (auto& name : listed_names(text, next + 1))
        names.push_back(std::move(name));
    } else if (word == "Exists" && sign == '(') {
      names.push_back(word_at(text, skip_blanks(text, next + 1)));
    } else if (word == "Include" && sign == '"') {
      const auto included = text.substr(next + 1, text.find('"', next + 1) - next - 1);
      collect(file.parent_path() / included, seen, names);
    }
    i += word.size() - 1;
  }
}

} // namespace

std::vector<std::string> geo_parameters(const std::string& file) {
  std::set<std::filesystem::path> seen;
  std::vector<std::string> all, names;
  collect(file, seen, all);
  for (auto& name : all)
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  return names;
}

} // namespace amontons
