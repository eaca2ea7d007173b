// Where the large tensors of a process lie.
#pragma once

namespace item3d {

/// From now on LibTorch's large tensors of the CPU have a region of their own, in large pages,
/// where they are reused: given back to the system each of their pages would be cleared anew, and
/// on the heap what is small and stays keeps what is large and goes apart. Without room for a
/// region, or with none left in it, they are on the heap as before.
void give_large_tensors_a_region();

}  // namespace item3d
