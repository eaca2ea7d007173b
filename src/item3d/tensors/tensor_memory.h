// The memory of a process's large tensors.
#pragma once

namespace item3d {

/// Reserves a region of large pages for LibTorch's large CPU tensors, and reuses it: memory
/// returned to the system would have to be cleared again page by page, and on the heap small
/// long-lived blocks fragment the large ones. Without space for a region, or when it is full,
/// tensors use the heap as before.
void give_large_tensors_a_region();

}  // namespace item3d
