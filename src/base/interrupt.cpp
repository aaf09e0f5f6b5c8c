#include "pellicle/base/interrupt.h"

#include <csignal>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {
// The one piece of process-wide state: a signal handler has no other way to speak.
volatile std::sig_atomic_t interrupted = 0;
void raise_flag(int) {
  interrupted = 1;
}
}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, raise_flag);
  std::signal(SIGTERM, raise_flag);
}

bool interrupt_requested() {
  return interrupted != 0;
}

void check_interrupt() {
  if (interrupt_requested()) throw Interrupted();
}

}  // namespace pellicle
