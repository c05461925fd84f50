// A form whose equations have branches that points jump between (contact that is open, sticks or slides): what
// detection and remedies in lib/solve see of it, as plain data. Nothing here changes which states are solutions once
// everything has been let go again: holds, held limits and another augmentation are ways to a solution.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace amontons {

class Switching {
 public:
  Switching() = default;
  Switching(const Switching&) = delete;
  Switching& operator=(const Switching&) = delete;
  virtual ~Switching() = default;

  /// What the points belong to, in messages (the name of a contact pair).
  virtual const std::string& switch_name() const = 0;
  /// Reference position of a point of this rank.
  virtual std::array<double, 3> switch_place(std::size_t point) const = 0;

  /// Branch of each point of this rank at the last evaluation, in an order that does not change: 0 is off (open), other
  /// numbers are on (1: sticks, 2: slides).
  virtual std::vector<std::uint8_t> branches() const = 0;

  enum class Hold : std::uint8_t { Free, Off, On };
  /// From the next evaluation on, points stay off or on whatever the state says (one for each point), or none does
  /// (empty).
  virtual void hold(std::vector<Hold> holds) = 0;
  /// Which points the state of the last evaluation would have on (1) or off (0), were none held. Valid while points
  /// are.
  virtual std::vector<std::uint8_t> wanted() const = 0;

  /// Does a limit depend on what the points carry (friction on pressure)?
  virtual bool has_limits() const = 0;
  /// Limits stay what the last evaluation made them, until they are released.
  virtual void hold_limits() = 0;
  virtual void release_limits() = 0;

  /// Makes the augmentation `factor` times what it is by the deck.
  virtual void scale_augmentation(double factor) = 0;
};

} // namespace amontons
