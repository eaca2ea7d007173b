#include "python/src/antialias.h"

#include "item3d/render/crossings.h"
#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/neighbours.h"
#include "python/src/value_checks.h"

#include <algorithm>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    Tensor image, raster, positions, triangles, neighbours, turned;
    std::int64_t views, per_view, channels, view_stride;
    Scratch<std::int32_t> triangle;
    Scratch<float> depth;
    kernels::AntialiasParameters p{};

    Inputs(const Operation& call, Pass pass, const Tensor& image_, const Tensor& raster_,
           const Tensor& positions_, const Tensor& triangles_, const Tensor& neighbours_,
           std::int64_t max_steps, bool bottom_up)
        : raster(call.checked("raster", raster_, ScalarType::Float, {-1, -1, -1, 4})),
          triangles(call.checked("triangles", triangles_, ScalarType::Int, {-1, 3})),
          neighbours(
              call.checked("topology", neighbours_, ScalarType::Int, {triangles.size(0), 3})),
          views(raster.size(0)),
          per_view(raster.size(1) * raster.size(2)),
          triangle(call.scratch<std::int32_t>(views * per_view)),
          depth(call.scratch<float>(views * per_view)) {
        const bool each = positions_.dim() == 3;
        image = call.checked("image", image_, ScalarType::Float,
                             {views, raster.size(1), raster.size(2), -1});
        positions = call.checked("positions", positions_, ScalarType::Float,
                                 each ? Sizes{views, -1, 4} : Sizes{-1, 4});
        const std::int64_t vertices = positions.size(each ? 1 : 0);
        ValueChecks checks(call, pass);
        checks.indices(triangles, vertices);
        checks.neighbours(neighbours);
        checks.raster(raster, triangles.size(0));
        checks.finish();
        channels = image.size(3);
        view_stride = each ? 4 * vertices : 0;
        turned = call.upside_down(positions, bottom_up);
        call.run<kernels::unpack_raster>(
            &Table::unpack_raster,
            kernels::UnpackParameters{floats(raster), triangle.data(), depth.data()},
            views * per_view, 16384);
        p = {floats(turned),
             integers(triangles),
             integers(neighbours),
             triangle.data(),
             depth.data(),
             vertices,
             static_cast<int>(raster.size(2)),
             static_cast<int>(raster.size(1)),
             static_cast<int>(std::clamp<std::int64_t>(max_steps, 1, 1 << 20))};
    }

    /// Returns the parameters of one view, with pixels counted from 0.
    kernels::AntialiasParameters of_view(std::int64_t view) const {
        kernels::AntialiasParameters one = p;
        one.positions_clip += view * view_stride;
        one.triangle += view * per_view;
        one.depth += view * per_view;
        return one;
    }
    /// Returns the parameters of the device's kernels for one view.
    kernels::BlendParameters blend_of_view(std::int64_t view) const {
        kernels::BlendParameters blend{};
        blend.raster = of_view(view);
        blend.image = floats(image) + view * per_view * channels;
        blend.channels = channels;
        return blend;
    }
};

template <typename F>
void for_each_crossing(const Inputs& in, const F& f) {
    for (std::int64_t view = 0; view < in.views && in.per_view > 0; ++view) {
        const kernels::AntialiasParameters one = in.of_view(view);
        for (const std::vector<kernels::Crossing>& row : list_crossings(one, 1))
            for (const kernels::Crossing& crossing : row)
                f(one, view, crossing);
    }
}

/// Computes the gradients on a device: each thread computes one pixel of by_image.
void blend_backward(const Operation& call, const Inputs& in, const Tensor& gradient,
                    const Tensor& by_image, const Accumulator& by_positions) {
    for (std::int64_t view = 0; view < in.views; ++view) {
        kernels::BlendParameters blend = in.blend_of_view(view);
        const std::int64_t first = view * in.per_view * in.channels;
        blend.gradient = floats(gradient) + first;
        blend.image_gradient = mutable_floats(by_image) + first;
        blend.clip_gradient = by_positions.from(view * in.view_stride);
        call.launch(&Table::antialias_backward, blend, in.per_view);
    }
}

}  // namespace

Tensor neighbours(const Tensor& triangles_, const std::optional<Tensor>& positions_) {
    const Operation call("topology", triangles_);
    const Tensor given = call.checked("triangles", triangles_, ScalarType::Int, {-1, 3});
    const Tensor triangles = call.on_cpu(given);
    std::vector<std::int32_t> merged;
    if (positions_) {
        const Tensor positions =
            call.on_cpu(call.checked("positions", *positions_, ScalarType::Float, {-1, 3}));
        ValueChecks checks(call, Pass::forward);
        checks.indices(given, positions.size(0));
        checks.finish();
        const float* in = floats(positions);
        std::vector<float> unsigned_zeros(in, in + positions.numel());
        for (float& value : unsigned_zeros)
            value += 0.0f;
        merged = merge_by_position(unsigned_zeros.data(), positions.size(0));
    }
    std::vector<std::int32_t> found(static_cast<std::size_t>(triangles.numel()));
    find_neighbours(integers(triangles), triangles.size(0), positions_ ? merged.data() : nullptr,
                    found.data());
    return torch::stable::view(call.upload(found.data(), triangles.numel(), ScalarType::Int),
                               {triangles.size(0), 3});
}

Tensor antialias(const Tensor& image, const Tensor& raster, const Tensor& positions,
                 const Tensor& triangles, const Tensor& neighbours, std::int64_t max_steps,
                 bool bottom_up) {
    const Operation call("antialias", raster);
    const Inputs in(call, Pass::forward, image, raster, positions, triangles, neighbours, max_steps,
                    bottom_up);
    const Tensor result = call.empty({in.views, in.raster.size(1), in.raster.size(2), in.channels});
    float* out = mutable_floats(result);
    if (call.on_device()) {
        for (std::int64_t view = 0; view < in.views; ++view) {
            kernels::BlendParameters blend = in.blend_of_view(view);
            blend.blended = out + view * in.per_view * in.channels;
            call.launch(&Table::antialias, blend, in.per_view);
        }
        return result;
    }
    const float* colors = floats(in.image);
    std::copy_n(colors, in.image.numel(), out);
    for_each_crossing(in, [&](const kernels::AntialiasParameters&, std::int64_t view,
                              const kernels::Crossing& crossing) {
        const std::int64_t first = view * in.per_view * in.channels;
        kernels::blend_crossing(crossing, colors + first, in.channels, out + first);
    });
    return result;
}

std::tuple<Tensor, Tensor> antialias_backward(const Tensor& image, const Tensor& raster,
                                              const Tensor& positions, const Tensor& triangles,
                                              const Tensor& neighbours, const Tensor& gradient_,
                                              std::int64_t max_steps, bool bottom_up,
                                              bool positions_wanted) {
    const Operation call("antialias backward", raster);
    const Inputs in(call, Pass::backward, image, raster, positions, triangles, neighbours,
                    max_steps, bottom_up);
    const Sizes sizes{in.views, in.raster.size(1), in.raster.size(2), in.channels};
    const Tensor gradient = call.checked("gradient", gradient_, ScalarType::Float, sizes);
    const Tensor by_image = call.empty(sizes);
    const Tensor by_positions =
        positions_wanted ? call.zeros(sizes_of(in.positions)) : call.empty({0});
    Accumulator sums;
    if (positions_wanted) sums.values = mutable_floats(by_positions);
    if (call.on_device()) {
        blend_backward(call, in, gradient, by_image, sums);
    } else {
        const float* by_result = floats(gradient);
        float* by_colors = mutable_floats(by_image);
        std::copy_n(by_result, in.image.numel(), by_colors);
        for_each_crossing(in, [&](const kernels::AntialiasParameters& one, std::int64_t view,
                                  const kernels::Crossing& crossing) {
            const std::int64_t first = view * in.per_view * in.channels;
            kernels::blend_crossing_backward(one, crossing, floats(in.image) + first,
                                             by_result + first, in.channels, by_colors + first,
                                             sums.from(view * in.view_stride));
        });
    }
    return {by_image, positions_wanted ? call.upside_down(by_positions, bottom_up) : by_positions};
}

}  // namespace item3d::python
