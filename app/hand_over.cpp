#include "hand_over.hpp"

#include "commands.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <unistd.h>

namespace amontons {

int hand_over_to_script(const std::string& name, std::vector<std::string> words) {
  const auto script = std::filesystem::path(AMONTONS_SCRIPTS) / name;
  if (const char* ranks = std::getenv("OMPI_COMM_WORLD_SIZE")) {
    // By every rank: the first to end has the others killed.
    std::cerr << "error: amontons " << name << " starts runs by itself, but was started on " << ranks
              << " rank(s) by mpirun. Call it without mpirun; --ranks says on how many its runs are." << std::endl;
    return status_wrong_input;
  }
  std::error_code ignored;
  words.insert(words.begin(), script.string());
  words.insert(words.end(), {"--program", std::filesystem::read_symlink("/proc/self/exe", ignored).string()});
  std::vector<char*> pointers;
  for (auto& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  std::cerr << "error: amontons " << name << " is the script " << script
            << ", which cannot be run: " << std::strerror(errno)
            << ". Keep the checkout that the program was built from." << std::endl;
  return status_wrong_input;
}

} // namespace amontons
