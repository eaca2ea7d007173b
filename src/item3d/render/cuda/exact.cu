// Kernels with decisions (inside or outside, nearer or farther). This file is compiled with
// -fmad=false (cmake/Cuda.cmake).
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

ITEM3D_EXACT_KERNELS(ITEM3D_KERNEL_DEFINITION)

}  // namespace item3d::cuda
