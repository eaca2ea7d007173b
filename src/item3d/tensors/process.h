// Process-wide settings of programs that compute with LibTorch.
#pragma once

namespace item3d {

/// Must be called before the first tensor is created, as programs and tests do.
///
/// On processors of Intel, makes CPU matrix products independent of the number of threads, bit for
/// bit (MKL_CBWR=AUTO,STRICT, unless the environment sets it). MKL has no such mode for others.
///
/// Reserves a region of large pages for large CPU tensors (see tensor_memory.cpp).
void prepare_process();

}  // namespace item3d
