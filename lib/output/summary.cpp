#include "output/summary.hpp"

#include "base/error.hpp"
#include "output/text_file.hpp"

#include <nlohmann/json.hpp>

namespace amontons {

void write_summary(MPI_Comm comm, const std::string& path, const nlohmann::ordered_json& summary) {
  on_root(comm, [&] {
    // Names from the deck or the mesh may hold bytes that are not UTF-8; a summary with a mark in their place is worth
    // more than none.
    write_atomically(path, summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
  });
}

} // namespace amontons
