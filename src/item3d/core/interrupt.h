// A program's own wish to stop at the next safe point, as Ctrl-C and SIGTERM are.
#pragma once

namespace item3d {

/// Sets interrupted() (progress.h) as a signal does. May be called from any thread.
void request_interrupt();

}  // namespace item3d
