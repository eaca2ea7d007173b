// Stops the program from within at the next safe point, as Ctrl-C and SIGTERM do.
#pragma once

namespace item3d {

/// Sets interrupted() (progress.h) as a signal does. Thread-safe.
void request_interrupt();

}  // namespace item3d
