// Kernels of texture lookups and mip levels.
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

ITEM3D_TEXTURE_KERNELS(ITEM3D_KERNEL_DEFINITION)

}  // namespace item3d::cuda
