#include "base/interrupt.hpp"

namespace amontons {

namespace {

volatile std::sig_atomic_t asked_to_stop = 0;

extern "C" void note_signal(int) { asked_to_stop = 1; }

} // namespace

InterruptScope::InterruptScope() {
  asked_to_stop = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  // SA_RESTART: system calls inside MPI and HDF5 go on; they are not written for EINTR.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < signals.size(); ++i)
    sigaction(signals[i], &action, &found_[i]);
}

InterruptScope::~InterruptScope() {
  for (std::size_t i = 0; i < signals.size(); ++i)
    sigaction(signals[i], &found_[i], nullptr);
}

bool interrupted(MPI_Comm comm) {
  const int mine = asked_to_stop;
  int any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, comm);
  return any != 0;
}

} // namespace amontons
