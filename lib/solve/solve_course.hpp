// The course of one solve, iterate by iterate: residuals and the branches of all points together, whether they repeat
// themselves, and what there is to say of that when the solve has failed.
#pragma once

#include "solve/iteration_record.hpp"
#include "solve/status_watch.hpp"
#include "solve/trouble.hpp"

namespace amontons {

class SolveCourse {
 public:
  /// Collective.
  SolveCourse(MPI_Comm comm, std::vector<WatchedPoints> points) : watch_(comm, std::move(points)) {}

  void clear();
  /// Takes the iterate whose residual was evaluated last: its norm relative to the forces in play. Collective.
  void observe(double residual);
  /// Would the solve go on like this for ever?
  bool repeats_itself() const { return record_.cycle() > 0 || record_.rests(); }
  /// Fills in what the iterations say of points and residual. Collective.
  void describe(Trouble& trouble) const;
  const StatusWatch& watch() const { return watch_; }

 private:
  IterationRecord record_;
  StatusWatch watch_;
};

} // namespace amontons
