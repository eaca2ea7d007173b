#include "item3d/render/interpolate.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/footprint.h"
#include "item3d/render/kernels/interpolate.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Returns the indices of covered pixels, ascending: [P] int64.
at::Tensor covered_pixels(const at::Tensor& triangle) {
    if (triangle.is_cuda()) return triangle.reshape({-1}).ge(0).nonzero().squeeze(1);
    const std::int64_t rows = triangle.size(0) * triangle.size(1), width = triangle.size(2);
    const std::int32_t* ids = triangle.const_data_ptr<std::int32_t>();
    const std::int64_t rows_a_block = std::max<std::int64_t>(1, 65536 / width);
    std::vector<std::int64_t> start(static_cast<std::size_t>(rows + 1), 0);
    parallel_for(
        "count_covered", rows,
        [&](std::int64_t row) {
            std::int64_t count = 0;
            for (std::int64_t x = 0; x < width; ++x)
                count += ids[row * width + x] >= 0;
            start[static_cast<std::size_t>(row + 1)] = count;
        },
        rows_a_block);
    for (std::size_t row = 1; row < start.size(); ++row)
        start[row] += start[row - 1];
    at::Tensor pixel = at::empty({start.back()}, at::kLong);
    std::int64_t* out = pixel.data_ptr<std::int64_t>();
    parallel_for(
        "list_covered", rows,
        [&](std::int64_t row) {
            std::int64_t next = start[static_cast<std::size_t>(row)];
            for (std::int64_t i = row * width; i < (row + 1) * width; ++i)
                if (ids[i] >= 0) out[next++] = i;
        },
        rows_a_block);
    return pixel;
}

struct InterpolateInput {
    at::Tensor triangles, barycentrics, triangle, pixel;
};

kernels::InterpolateParameters interpolate_parameters(const InterpolateInput& input,
                                                      const at::Tensor& attributes,
                                                      const at::Tensor& positions_clip) {
    kernels::InterpolateParameters p{};
    p.attributes = attributes.const_data_ptr<float>();
    p.positions_clip = positions_clip.const_data_ptr<float>();
    p.triangles = input.triangles.const_data_ptr<std::int32_t>();
    p.barycentrics = input.barycentrics.const_data_ptr<float>();
    p.triangle = input.triangle.const_data_ptr<std::int32_t>();
    p.pixel = input.pixel.const_data_ptr<std::int64_t>();
    p.vertices = attributes.size(0);
    p.channels = static_cast<int>(attributes.size(1));
    p.width = static_cast<int>(input.triangle.size(2));
    p.height = static_cast<int>(input.triangle.size(1));
    return p;
}

/// Interpolates attributes [V, A] to [P, A]. Differentiable in the attributes and in positions_clip
/// [N, V, 4].
struct Interpolate : torch::autograd::Function<Interpolate> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& attributes,
                              const at::Tensor& positions_clip, const InterpolateInput& input) {
        at::Tensor values =
            at::empty({input.pixel.size(0), attributes.size(1)}, attributes.options());
        kernels::InterpolateParameters p =
            interpolate_parameters(input, attributes, positions_clip);
        p.values = values.data_ptr<float>();
        dispatch<kernels::interpolate_forward>(values.device(), "interpolate",
                                               &cuda::RenderTable::interpolate, p, values.size(0),
                                               8192);
        context->save_for_backward({attributes, positions_clip, input.triangles, input.barycentrics,
                                    input.triangle, input.pixel});
        return values;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto saved = context->get_saved_variables();
        const InterpolateInput input{saved[2], saved[3], saved[4], saved[5]};
        const at::Tensor gradient = gradients[0].contiguous();
        const std::int64_t count = input.pixel.size(0);
        kernels::InterpolateParameters p = interpolate_parameters(input, saved[0], saved[1]);
        p.value_gradient = gradient.const_data_ptr<float>();
        if (gradient.is_cuda()) {
            const std::int64_t attributes = saved[0].numel();
            const bool moves = context->needs_input_grad(1);
            const at::Tensor sums =
                cuda::sum_on_device(attributes + (moves ? saved[1].numel() : 0), 3 * count,
                                    gradient.device(), [&](const Accumulator& accumulator) {
                                        p.attribute_gradient = accumulator;
                                        if (moves) p.clip_gradient = accumulator.from(attributes);
                                        cuda::run(cuda::render_table().interpolate_backward, p,
                                                  count, gradient.device());
                                    });
            return {sums.narrow(0, 0, attributes).view(saved[0].sizes()),
                    moves ? sums.narrow(0, attributes, saved[1].numel()).view(saved[1].sizes())
                          : at::Tensor(),
                    at::Tensor()};
        }
        at::Tensor attribute_gradient = at::zeros_like(saved[0]);
        at::Tensor clip_gradient;
        p.attribute_gradient.values = attribute_gradient.data_ptr<float>();
        if (context->needs_input_grad(1)) {
            clip_gradient = at::zeros_like(saved[1]);
            p.clip_gradient.values = clip_gradient.data_ptr<float>();
        }
        // One thread adds all gradients, because pixels share vertices, and sums in a fixed order
        // are reproducible.
        for (std::int64_t i = 0; i < count; ++i)
            kernels::interpolate_backward(p, i);
        return {attribute_gradient, clip_gradient, at::Tensor()};
    }
};

at::Tensor camera_positions(const std::vector<Camera>& cameras) {
    at::Tensor positions = at::empty({static_cast<std::int64_t>(cameras.size()), 3});
    float* out = positions.data_ptr<float>();
    for (const Camera& camera : cameras) {
        kernels::store3(out, camera.position());
        out += 3;
    }
    return positions;
}

at::Tensor unit_rows(const at::Tensor& rows) {
    return rows / rows.norm(2, 1, true).clamp_min(1e-12f);
}

}  // namespace

Surface interpolate_surface(const Geometry& geometry, const Raster& raster,
                            const std::vector<Camera>& cameras) {
    constexpr const char* op = "interpolate_surface";
    constexpr auto real = at::kFloat;
    const at::Device device = operation_device(op, geometry.positions);
    const std::int64_t vertices = geometry.positions.size(0);
    const std::int64_t triangle_count = geometry.triangles.size(0);
    const at::Tensor positions =
        checked(op, "positions", geometry.positions, real, {-1, 3}, device);
    const at::Tensor normals =
        checked(op, "normals", geometry.normals, real, {vertices, 3}, device);
    const at::Tensor tangents =
        checked(op, "tangents", geometry.tangents, real, {vertices, 4}, device);
    const at::Tensor uvs = checked(op, "uvs", geometry.uvs, real, {vertices, 2}, device);
    const at::Tensor colors = checked(op, "colors", geometry.colors, real, {vertices, 4}, device);
    const at::Tensor triangles =
        checked(op, "triangles", geometry.triangles, at::kInt, {-1, 3}, device);
    const at::Tensor materials = checked(op, "triangle_material", geometry.triangle_material,
                                         at::kInt, {triangle_count}, device);
    const at::Tensor primitives = checked(op, "triangle_primitive", geometry.triangle_primitive,
                                          at::kInt, {triangle_count}, device);
    const at::Tensor triangle =
        checked(op, "raster.triangle", raster.triangle, at::kInt, {-1, -1, -1}, device);
    const at::Tensor barycentrics =
        checked(op, "raster.barycentrics", raster.barycentrics, real,
                {raster.views(), raster.height(), raster.width(), 2}, device);
    ITEM3D_CHECK(static_cast<int>(cameras.size()) == raster.views(),
                 "interpolate_surface: expected the raster's " + std::to_string(raster.views()) +
                     " cameras, found " + std::to_string(cameras.size()));

    Surface surface;
    surface.pixel = covered_pixels(triangle);
    const std::int64_t count = surface.count();
    surface.triangle = triangle.reshape({-1}).index_select(0, surface.pixel).to(at::kLong);
    const at::Tensor eyes = camera_positions(cameras).to(device);
    const auto options = at::TensorOptions().dtype(real).device(device);
    surface.position = at::empty({count, 3}, options);
    surface.normal = at::empty({count, 3}, options);
    surface.tangent = at::empty({count, 4}, options);
    surface.uv = at::empty({count, 2}, options);
    surface.color = at::empty({count, 4}, options);
    surface.view = at::empty({count, 3}, options);
    surface.material = at::empty({count}, options.dtype(at::kLong));
    surface.primitive = at::empty({count}, options.dtype(at::kLong));
    const kernels::SurfaceParameters parameters{
        positions.const_data_ptr<float>(),
        normals.const_data_ptr<float>(),
        tangents.const_data_ptr<float>(),
        uvs.const_data_ptr<float>(),
        colors.const_data_ptr<float>(),
        triangles.const_data_ptr<std::int32_t>(),
        materials.const_data_ptr<std::int32_t>(),
        primitives.const_data_ptr<std::int32_t>(),
        barycentrics.const_data_ptr<float>(),
        triangle.const_data_ptr<std::int32_t>(),
        eyes.const_data_ptr<float>(),
        static_cast<std::int64_t>(raster.height()) * raster.width(),
        surface.pixel.const_data_ptr<std::int64_t>(),
        surface.position.data_ptr<float>(),
        surface.normal.data_ptr<float>(),
        surface.tangent.data_ptr<float>(),
        surface.uv.data_ptr<float>(),
        surface.color.data_ptr<float>(),
        surface.view.data_ptr<float>(),
        surface.material.data_ptr<std::int64_t>(),
        surface.primitive.data_ptr<std::int64_t>()};
    dispatch<kernels::interpolate_surface_point>(device, "interpolate_surface",
                                                 &cuda::RenderTable::interpolate_surface,
                                                 parameters, count, 8192);

    for (const at::Tensor& further : geometry.further_uvs) {
        const at::NoGradGuard no_grad;
        const at::Tensor map = checked(op, "further_uvs", further, real, {vertices, 2}, device);
        surface.further_uvs.push_back(
            Interpolate::apply(map, raster.positions_clip,
                               InterpolateInput{triangles, barycentrics, triangle, surface.pixel}));
    }

    const bool moves = positions.requires_grad() || raster.positions_clip.requires_grad();
    if (at::GradMode::is_enabled() && (moves || normals.requires_grad())) {
        const at::Tensor attributes = at::cat({positions, normals}, 1);
        const at::Tensor values =
            Interpolate::apply(attributes, raster.positions_clip,
                               InterpolateInput{triangles, barycentrics, triangle, surface.pixel});
        const at::Tensor raw = values.narrow(1, 3, 3);
        const at::Tensor turned = ((raw.detach() * surface.normal).sum(1, true) < 0).to(real);
        surface.normal = unit_rows(raw) * (1 - 2 * turned);
        if (moves) {
            surface.position = values.narrow(1, 0, 3);
            const at::Tensor view_index = at::floor_divide(
                surface.pixel, static_cast<std::int64_t>(raster.height()) * raster.width());
            surface.view = unit_rows(eyes.index_select(0, view_index) - surface.position);
        }
    }
    return surface;
}

namespace {

at::Tensor footprints_of(const at::Tensor& map, const Geometry& geometry, const Raster& raster,
                         const Surface& surface) {
    constexpr const char* op = "uv_footprints";
    constexpr auto real = at::kFloat;
    const at::Device device = operation_device(op, geometry.positions);
    const std::int64_t vertices = geometry.positions.size(0);
    const at::Tensor positions_clip = checked(op, "raster.positions_clip", raster.positions_clip,
                                              real, {raster.views(), vertices, 4}, device);
    const at::Tensor triangles =
        checked(op, "triangles", geometry.triangles, at::kInt, {-1, 3}, device);
    const at::Tensor uvs = checked(op, "uvs", map, real, {vertices, 2}, device);
    const at::Tensor triangle =
        checked(op, "raster.triangle", raster.triangle, at::kInt, {-1, -1, -1}, device);
    const at::Tensor pixel = checked(op, "surface.pixel", surface.pixel, at::kLong, {-1}, device);
    at::Tensor footprint = at::empty({surface.count(), 4}, uvs.options());
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

}  // namespace

at::Tensor uv_footprints(const Geometry& geometry, const Raster& raster, const Surface& surface) {
    return footprints_of(geometry.uvs, geometry, raster, surface);
}

void add_uv_footprints(const Geometry& geometry, const Raster& raster, Surface& surface) {
    surface.uv_footprint = uv_footprints(geometry, raster, surface);
    surface.further_uv_footprints.clear();
    for (const at::Tensor& map : geometry.further_uvs)
        surface.further_uv_footprints.push_back(footprints_of(map, geometry, raster, surface));
}

}  // namespace item3d
