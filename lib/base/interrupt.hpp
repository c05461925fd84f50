// Being asked to stop (Ctrl-C, a batch system's warning) turned into a question that the solver asks at safe places.
#pragma once

#include <array>
#include <csignal>
#include <mpi.h>

namespace amontons {

/// While it lives, SIGINT, SIGTERM and SIGUSR1 set a flag instead of ending the process. Open MPI's mpirun passes
/// SIGUSR1 on as it is; to SIGINT and SIGTERM it answers by SIGTERM to its ranks and SIGKILL one second later, whatever
/// they do, and by an exit status of its own. So what must survive has to be on disk within a second, or SIGUSR1 be
/// sent instead. A second signal of the same kind has its default effect, so that a run that does not get to ask can
/// still be ended. The handlers found (PETSc's) come back at the end of the scope. One at a time, made after
/// PetscInitialize.
class InterruptScope {
 public:
  InterruptScope();
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

 private:
  static constexpr std::array signals = {SIGINT, SIGTERM, SIGUSR1};
  std::array<struct sigaction, signals.size()> found_{};
};

/// Has any rank been asked to stop since the InterruptScope began? The same answer on every rank. Collective.
bool interrupted(MPI_Comm comm);

} // namespace amontons
