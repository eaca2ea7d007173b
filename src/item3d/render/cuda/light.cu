// Kernels that prefilter environments.
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

ITEM3D_LIGHT_KERNELS(ITEM3D_KERNEL_DEFINITION)

}  // namespace item3d::cuda
