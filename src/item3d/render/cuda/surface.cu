// Kernels over surface points and texels, and the table of all of the renderer's.
#include "item3d/render/cuda/entries.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

int interpolate_surface(const kernels::SurfaceParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "interpolate_surface", count,
        [=] __device__(std::int64_t i) { kernels::interpolate_surface_point(p, i); }, stream);
}

int interpolate(const kernels::InterpolateParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "interpolate", count,
        [=] __device__(std::int64_t i) { kernels::interpolate_forward(p, i); }, stream);
}

int interpolate_backward(const kernels::InterpolateParameters& p, std::int64_t count,
                         Stream stream) {
    return launch(
        "interpolate backward", count,
        [=] __device__(std::int64_t i) { kernels::interpolate_backward(p, i); }, stream);
}

int shade(const kernels::ShadeParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "shade", count, [=] __device__(std::int64_t i) { kernels::shade_forward(p, i); }, stream);
}

int shade_backward(const kernels::ShadeBackwardParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "shade backward", count,
        [=] __device__(std::int64_t i) { kernels::shade_backward(p.shade, i, p.light); }, stream);
}

int equirectangular(const kernels::EquirectangularParameters& p, std::int64_t count,
                    Stream stream) {
    return launch(
        "equirectangular_to_cube", count,
        [=] __device__(std::int64_t i) { kernels::equirectangular_forward(p, i); }, stream);
}

int equirectangular_backward(const kernels::EquirectangularParameters& p, std::int64_t count,
                             Stream stream) {
    return launch(
        "equirectangular_to_cube backward", count,
        [=] __device__(std::int64_t i) { kernels::equirectangular_backward(p, i); }, stream);
}

int uv_footprints(const kernels::FootprintParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "uv_footprints", count, [=] __device__(std::int64_t i) { kernels::uv_footprint(p, i); },
        stream);
}

int scatter_background(const kernels::ScatterParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "scatter background", count,
        [=] __device__(std::int64_t i) { kernels::scatter_background(p, i); }, stream);
}

int scatter_values(const kernels::ScatterParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "scatter", count, [=] __device__(std::int64_t i) { kernels::scatter_value(p, i); }, stream);
}

int occlusion(const kernels::OcclusionParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "occlusion", count, [=] __device__(std::int64_t i) { kernels::occlusion_at(p, i); },
        stream);
}

int finish_sums(const FinishSumsParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "finish_sums", count, [=] __device__(std::int64_t i) { finish_sum(p, i); }, stream);
}

namespace {

const char* error_text(int error) {
    return cudaGetErrorString(static_cast<cudaError_t>(error));
}

constexpr RenderTable table{{table_version, sizeof(RenderTable)},
                            error_text,
                            project_vertices,
                            bound_triangles,
                            rasterize_keys,
                            resolve_keys,
                            interpolate_surface,
                            interpolate,
                            interpolate_backward,
                            shade,
                            shade_backward,
                            antialias,
                            antialias_backward,
                            equirectangular,
                            equirectangular_backward,
                            uv_footprints,
                            texture,
                            texture_backward,
                            texture_uv_backward,
                            halve_texture,
                            halve_texture_backward,
                            scatter_background,
                            scatter_values,
                            finish_sums,
                            occlusion,
                            fill_halo_side,
                            fill_halo_corner,
                            upsample_cube,
                            restrict_cube,
                            map_to_planes,
                            planes_to_map,
                            planes_to_means,
                            cube_directions,
                            add_near_sums,
                            turn_planes,
                            far_sums,
                            far_absolute_cosine,
                            fold,
                            row_moments,
                            join_cosine,
                            add_bright,
                            sum_bright,
                            set_bright};

}  // namespace
}  // namespace item3d::cuda

extern "C" __attribute__((visibility("default"))) const item3d::cuda::RenderTable*
item3d_cuda_render() {
    return &item3d::cuda::table;
}
