// The memory that is free for programs.
#pragma once

namespace item3d {

/// Returns the number of bytes that processes may still allocate. It is MemAvailable, limited by
/// this process's control group, such as a cluster job's. Returns 1e18 if the system does not
/// report the number.
double available_memory();

}  // namespace item3d
