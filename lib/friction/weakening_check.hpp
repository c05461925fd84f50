// A check that the decks of several laws share.
#pragma once

#include "deck/rule.hpp"

namespace amontons {

/// Notes a fault when mu_k > mu_s.
template <class Law>
void check_weakens(const DeckNode& node, const Law& law, Reading& reading) {
  if (law.mu_k > law.mu_s)
    reading.fail(node.place, node.path + " must have mu_k <= mu_s, but has " + number_text(law.mu_k) + " > " +
                                 number_text(law.mu_s) + ".");
}

} // namespace amontons
