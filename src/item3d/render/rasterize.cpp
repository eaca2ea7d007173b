#include "item3d/render/rasterize.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/project.h"
#include "item3d/render/raster_bands.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <vector>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Multiplies positions [V, 3] by column-major matrices [N, 4, 4]. The result is [N, V, 4].
struct ProjectVertices : torch::autograd::Function<ProjectVertices> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& positions,
                              const at::Tensor& world_to_clip) {
        const std::int64_t vertices = positions.size(0), views = world_to_clip.size(0);
        at::Tensor positions_clip = at::empty({views, vertices, 4}, positions.options());
        const kernels::ProjectParameters parameters{positions.const_data_ptr<float>(),
                                                    world_to_clip.const_data_ptr<float>(),
                                                    positions_clip.data_ptr<float>(), vertices};
        dispatch<kernels::project_vertex>(positions.device(), "project_vertices",
                                          &cuda::RenderTable::project_vertices, parameters,
                                          views * vertices, 32768);
        context->save_for_backward({world_to_clip});
        return positions_clip;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        // The column-major matrices are stored as their transposes: element [n][column][row].
        const at::Tensor transposed = context->get_saved_variables()[0].narrow(1, 0, 3);
        return {at::matmul(gradients[0], transposed.transpose(1, 2)).sum(0), at::Tensor()};
    }
};

at::Tensor clip_matrices(const std::vector<Camera>& cameras, int width, int height) {
    at::Tensor matrices = at::empty({static_cast<std::int64_t>(cameras.size()), 4, 4});
    float* out = matrices.data_ptr<float>();
    for (std::size_t n = 0; n < cameras.size(); ++n) {
        const Mat4 matrix = cameras[n].world_to_clip(width, height);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                out[16 * n + 4 * column + row] = matrix[column][row];
    }
    return matrices;
}

/// Rasterizes with one thread for each triangle and band of rows.
void rasterize_on_cuda(const kernels::RasterParameters& parameters, std::int64_t views,
                       at::Device device) {
    const std::int64_t triangles = views * parameters.triangle_count;
    const std::int64_t pixels =
        views * static_cast<std::int64_t>(parameters.width) * parameters.height;
    const at::Tensor keys =
        at::zeros({pixels}, at::TensorOptions().dtype(at::kLong).device(device));
    const kernels::KeyedRasterParameters keyed{
        parameters, static_cast<unsigned long long*>(keys.data_ptr()), views,
        kernels::key_bands(triangles, parameters.height)};
    const cuda::RenderTable& table = cuda::render_table();
    cuda::run(table.bound_triangles, parameters, triangles, device);
    cuda::run(table.rasterize_keys, keyed, triangles * keyed.bands, device);
    cuda::run(table.resolve_keys, keyed, pixels, device);
}

}  // namespace

Raster rasterize(const Geometry& geometry, const std::vector<Camera>& cameras, int width,
                 int height, const at::Tensor& behind_) {
    ITEM3D_CHECK(width > 0 && height > 0 && width <= 16384 && height <= 16384,
                 "rasterize: width and height must be in [1, 16384], found " +
                     std::to_string(width) + " x " + std::to_string(height));
    ITEM3D_CHECK(!cameras.empty(), "rasterize: at least one camera");
    const at::Device device = operation_device("rasterize", geometry.positions);
    const at::Tensor positions =
        checked("rasterize", "positions", geometry.positions, at::kFloat, {-1, 3}, device);
    const at::Tensor triangles =
        checked("rasterize", "triangles", geometry.triangles, at::kInt, {-1, 3}, device);
    const std::int64_t views = static_cast<std::int64_t>(cameras.size());
    const at::Tensor behind =
        behind_.defined()
            ? checked("rasterize", "behind", behind_, at::kFloat, {views, height, width}, device)
            : at::Tensor();

    Raster raster;
    raster.positions_clip =
        ProjectVertices::apply(positions, clip_matrices(cameras, width, height).to(device));
    const auto real = at::TensorOptions().dtype(at::kFloat).device(device);
    raster.barycentrics = at::zeros({views, height, width, 2}, real);
    raster.depth = at::zeros({views, height, width}, real);
    raster.triangle = at::full({views, height, width}, -1, real.dtype(at::kInt));

    const std::int64_t triangle_count = triangles.size(0);
    at::Tensor boxes =
        at::empty({views * triangle_count, static_cast<std::int64_t>(sizeof(kernels::PixelBox))},
                  real.dtype(at::kByte));
    const kernels::RasterParameters parameters{
        raster.positions_clip.const_data_ptr<float>(),
        triangles.const_data_ptr<std::int32_t>(),
        static_cast<kernels::PixelBox*>(boxes.data_ptr()),
        positions.size(0),
        triangle_count,
        width,
        height,
        raster.barycentrics.data_ptr<float>(),
        raster.depth.data_ptr<float>(),
        raster.triangle.data_ptr<std::int32_t>(),
        behind.defined() ? behind.const_data_ptr<float>() : nullptr};
    if (device.is_cuda())
        rasterize_on_cuda(parameters, views, device);
    else
        rasterize_on_cpu(parameters, views);
    return raster;
}

}  // namespace item3d
