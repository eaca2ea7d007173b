// The memory that is free for programs.
#pragma once

namespace item3d {

/// Returns the bytes that processes may still allocate (MemAvailable, limited by this process's
/// control group, such as a cluster job's); 1e18 where the system does not report it.
double available_memory();

}  // namespace item3d
