// The memory of a process's large tensors.
#pragma once

namespace item3d {

/// Reserves a region of large pages for LibTorch's large CPU tensors, and reuses it. The system
/// would clear returned memory again, page by page. On the heap, small long-lived blocks would
/// fragment the memory of the large ones. If the region is full or cannot be reserved, tensors use
/// the heap.
void give_large_tensors_a_region();

}  // namespace item3d
