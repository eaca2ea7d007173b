#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/footprint.h"
#include "item3d/render/rasterize.h"

namespace item3d {

torch::Tensor uv_footprints(const Geometry& geometry, const Raster& raster,
                            const Surface& surface) {
    constexpr const char* op = "uv_footprints";
    constexpr auto real = torch::kFloat32;
    const torch::Device device = operation_device(op, geometry.positions);
    const std::int64_t vertices = geometry.positions.size(0);
    const torch::Tensor positions_clip = checked(op, "raster.positions_clip", raster.positions_clip,
                                                 real, {raster.views(), vertices, 4}, device);
    const torch::Tensor triangles =
        checked(op, "triangles", geometry.triangles, torch::kInt32, {-1, 3}, device);
    const torch::Tensor uvs = checked(op, "uvs", geometry.uvs, real, {vertices, 2}, device);
    const torch::Tensor triangle =
        checked(op, "raster.triangle", raster.triangle, torch::kInt32, {-1, -1, -1}, device);
    const torch::Tensor pixel =
        checked(op, "surface.pixel", surface.pixel, torch::kInt64, {-1}, device);
    torch::Tensor footprint = torch::empty({surface.count(), 4}, uvs.options());
    const kernels::FootprintParameters parameters{positions_clip.const_data_ptr<float>(),
                                                  triangles.const_data_ptr<std::int32_t>(),
                                                  uvs.const_data_ptr<float>(),
                                                  triangle.const_data_ptr<std::int32_t>(),
                                                  pixel.const_data_ptr<std::int64_t>(),
                                                  vertices,
                                                  raster.width(),
                                                  raster.height(),
                                                  footprint.data_ptr<float>()};
    dispatch<kernels::uv_footprint>(device, "uv_footprints", &cuda::RenderTable::uv_footprints,
                                    parameters, surface.count(), 4096);
    return footprint;
}

}  // namespace item3d
