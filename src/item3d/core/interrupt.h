// Ctrl-C, SIGTERM, and a program's own wish to stop at the next safe point.
#pragma once

namespace item3d {

/// Makes Ctrl-C (SIGINT) and SIGTERM set interrupted(). A second Ctrl-C ends the program at once;
/// SIGTERM may come several times, as schedulers send it.
void install_interrupt_handler();

/// Sets interrupted() as a signal does. May be called from any thread.
void request_interrupt();

/// Whether to stop. Loops poll it at safe points.
bool interrupted();

}  // namespace item3d
