// Memory that is free for programs.
#pragma once

namespace item3d {

/// Bytes that processes may still take (MemAvailable, and what the control group of this process
/// leaves of its limit, as of a cluster's job); 1e18 where the system does not say.
double available_memory();

}  // namespace item3d
