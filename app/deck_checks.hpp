// Checks of a deck in itself that no single key can make: names that refer to each other, conditions that contradict
// each other, what fits the space. They need no mesh.
#pragma once

#include "deck.hpp"
#include "deck/node.hpp"
#include "deck/reading.hpp"

#include <string>
#include <vector>

namespace amontons {

/// Notes every contradiction of the deck in `reading`; skips what rests on parts that already have a fault.
void check_deck(const Deck& deck, const DeckNode& root, Reading& reading);

/// Notes a mesh file that is not there.
void check_mesh_file_exists(const Deck& deck, const DeckNode& root, Reading& reading);

/// A sentence about files in the same folder with one of the endings: the nearest match, or those that there are.
std::string nearest_file(const std::string& path, const std::vector<std::string>& endings);

} // namespace amontons
