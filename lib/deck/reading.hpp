// The state of reading one deck: the messages collected so far and the names that expressions may use.
#pragma once

#include "deck/located.hpp"

#include <map>
#include <string>
#include <vector>

namespace amontons {

struct DeckNode;
struct Shape;

/// Names that expressions under one entry of a map know besides the deck's constants: `rho` of a body, for example.
struct EntryNames {
  std::map<std::string, double> constants;
  std::map<std::string, std::string> missing; // a name that has no value here, and the sentence that says why
};

class Reading {
 public:
  /// Notes a fault of the deck; reading goes on so that all faults are found in one go.
  void fail(const Place& place, const std::string& message);
  std::size_t num_faults() const { return faults_.size(); }
  /// Has a fault been noted at this node or below it?
  bool has_fault(const DeckNode& node) const;
  /// Throws a UserError with all the messages in the order of the file, if there are any.
  void finish() const;

  /// Known to numbers and expressions.
  std::map<std::string, double> constants;
  /// Sentences about names that are unknown for a reason.
  std::map<std::string, std::string> missing;
  /// Extra names by key, for the map rules that ask for them (see map_of).
  std::map<std::string, EntryNames> entry_names;

  /// While the value of a tag is read: the alternatives that it belongs to, to explain a key that belongs to another.
  const Shape* alternatives = nullptr;

 private:
  struct Fault {
    Place place;
    std::string message;
  };
  std::vector<Fault> faults_;
};

} // namespace amontons
