#pragma once
/// Cooperative interruption: a signal handler raises a flag, long loops look at it.

namespace pellicle {

/// From now on SIGINT and SIGTERM raise the flag instead of ending the process at once. Called by the CLI only.
void install_interrupt_handler();
/// Whether the flag is up; what the command line gives as Observer::stopped.
bool interrupt_requested();
/// \throws Interrupted when the flag is up. Cheap; called between steps of a fit and between phases.
void check_interrupt();

}  // namespace pellicle
