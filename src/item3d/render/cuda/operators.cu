// Kernels of the Python package's operators. The kernels that tell whether a pixel is inside a
// triangle or not are those of the renderer (exact.cu).
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

ITEM3D_OPERATOR_KERNELS(ITEM3D_KERNEL_DEFINITION)

}  // namespace item3d::cuda
