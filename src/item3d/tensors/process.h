// What a program that computes with LibTorch sets for its whole process.
#pragma once

namespace item3d {

/// Call it before the first tensor is made; programs and tests do alike.
///
/// Matrix products of the CPU give the same bytes for any number of threads (MKL_CBWR=AUTO,STRICT,
/// unless the environment says otherwise).
///
/// Large tensors of the CPU have a region of their own, in large pages, where they are reused (see
/// tensor_memory.cpp).
void prepare_process();

}  // namespace item3d
