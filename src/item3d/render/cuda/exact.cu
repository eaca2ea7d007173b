// Kernels that decide (inside or outside, nearer or farther, crossed or not). Compiled with
// -fmad=false (cmake/Cuda.cmake): without fused products they decide as the CPU does, to the bit.
#include "item3d/render/cuda/entries.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

int project_vertices(const kernels::ProjectParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "project_vertices", count,
        [=] __device__(std::int64_t i) { kernels::project_vertex(p, i); }, stream);
}

int bound_triangles(const kernels::RasterParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "bound_triangles", count,
        [=] __device__(std::int64_t i) {
            kernels::bound_triangle(p, i / p.triangle_count, i % p.triangle_count);
        },
        stream);
}

int rasterize_keys(const kernels::KeyedRasterParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "rasterize", count, [=] __device__(std::int64_t i) { kernels::rasterize_keys(p, i); },
        stream);
}

int resolve_keys(const kernels::KeyedRasterParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "resolve_raster", count, [=] __device__(std::int64_t i) { kernels::resolve_key(p, i); },
        stream);
}

int antialias(const kernels::BlendParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "antialias", count, [=] __device__(std::int64_t i) { kernels::blend_pixel(p, i); }, stream);
}

int antialias_backward(const kernels::BlendParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "antialias backward", count,
        [=] __device__(std::int64_t i) { kernels::blend_pixel_backward(p, i); }, stream);
}

}  // namespace item3d::cuda
