// Requests by the program itself to stop at the next safe point, like Ctrl-C and SIGTERM.
#pragma once

namespace item3d {

/// Sets interrupted() (progress.h) as a signal does. Thread-safe.
void request_interrupt();

}  // namespace item3d
