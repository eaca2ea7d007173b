// Kernels over surface points and texels, and the table of all of the renderer's kernels.
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

ITEM3D_RENDER_KERNELS(ITEM3D_KERNEL_PROTOTYPE)
ITEM3D_SURFACE_KERNELS(ITEM3D_KERNEL_DEFINITION)

namespace {

const char* error_text(int error) {
    return cudaGetErrorString(static_cast<cudaError_t>(error));
}

constexpr RenderTable table{.header = {table_version, sizeof(RenderTable)},
                            .error_text = error_text,
                            ITEM3D_RENDER_KERNELS(ITEM3D_KERNEL_INITIALIZER)};

}  // namespace
}  // namespace item3d::cuda

extern "C" __attribute__((visibility("default"))) const item3d::cuda::RenderTable*
item3d_cuda_render() {
    return &item3d::cuda::table;
}
