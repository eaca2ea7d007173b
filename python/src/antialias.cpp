#include "python/src/antialias.h"

#include "item3d/render/crossings.h"
#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/neighbours.h"

#include <algorithm>
#include <atomic>

namespace item3d::python {
namespace {

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    Tensor image, raster, positions, triangles, neighbours;
    std::int64_t views, per_view, channels, view_stride;
    std::vector<float> turned, depth;
    std::vector<std::int32_t> triangle;
    kernels::AntialiasParameters p{};

    Inputs(const char* operation, const Tensor& image_, const Tensor& raster_,
           const Tensor& positions_, const Tensor& triangles_, const Tensor& neighbours_,
           std::int64_t max_steps, bool bottom_up)
        : raster(checked(operation, "raster", raster_, ScalarType::Float, {-1, -1, -1, 4})),
          triangles(checked(operation, "triangles", triangles_, ScalarType::Int, {-1, 3})),
          neighbours(
              checked(operation, "topology", neighbours_, ScalarType::Int, {triangles.size(0), 3})),
          views(raster.size(0)),
          per_view(raster.size(1) * raster.size(2)),
          depth(static_cast<std::size_t>(views * per_view)),
          triangle(depth.size()) {
        const bool each = positions_.dim() == 3;
        image = checked(operation, "image", image_, ScalarType::Float,
                        {views, raster.size(1), raster.size(2), -1});
        positions = checked(operation, "positions", positions_, ScalarType::Float,
                            each ? Sizes{views, -1, 4} : Sizes{-1, 4});
        const std::int64_t vertices = positions.size(each ? 1 : 0);
        check_indices(operation, triangles, vertices);
        const std::int32_t* beyond = integers(neighbours);
        const std::int64_t corners = triangles.numel();
        for (std::int64_t i = 0; i < corners; ++i)
            if (beyond[i] < -1 || beyond[i] >= corners)
                fail(operation, "topology is not that of these triangles");
        channels = image.size(3);
        view_stride = each ? 4 * vertices : 0;
        turned = upside_down(positions, bottom_up);
        unpack(operation);
        p = {bottom_up ? turned.data() : floats(positions),
             integers(triangles),
             beyond,
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

  private:
    void unpack(const char* operation) {
        const float* in = floats(raster);
        const std::int64_t maximum = triangles.size(0);
        std::atomic<bool> unknown{false};
        parallel_for(
            operation, views * per_view,
            [&](std::int64_t pixel) {
                const std::int64_t t = kernels::triangle_at(in, pixel);
                if (t >= maximum) unknown = true;
                triangle[static_cast<std::size_t>(pixel)] = static_cast<std::int32_t>(t);
                depth[static_cast<std::size_t>(pixel)] = in[4 * pixel + 2];
            },
            16384);
        if (unknown)
            fail(operation, "raster names triangles beyond the " + std::to_string(maximum) +
                                " that are given");
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

}  // namespace

Tensor neighbours(const Tensor& triangles_, const std::optional<Tensor>& positions_) {
    constexpr const char* operation = "topology";
    const Tensor triangles = checked(operation, "triangles", triangles_, ScalarType::Int, {-1, 3});
    std::vector<std::int32_t> merged;
    if (positions_) {
        const Tensor positions =
            checked(operation, "positions", *positions_, ScalarType::Float, {-1, 3});
        check_indices(operation, triangles, positions.size(0));
        const float* in = floats(positions);
        std::vector<float> unsigned_zeros(in, in + positions.numel());
        for (float& value : unsigned_zeros)
            value += 0.0f;
        merged = merge_by_position(unsigned_zeros.data(), positions.size(0));
    }
    const Tensor result = new_tensor({triangles.size(0), 3}, ScalarType::Int);
    find_neighbours(integers(triangles), triangles.size(0), positions_ ? merged.data() : nullptr,
                    static_cast<std::int32_t*>(result.mutable_data_ptr()));
    return result;
}

Tensor antialias(const Tensor& image, const Tensor& raster, const Tensor& positions,
                 const Tensor& triangles, const Tensor& neighbours, std::int64_t max_steps,
                 bool bottom_up) {
    const Inputs in("antialias", image, raster, positions, triangles, neighbours, max_steps,
                    bottom_up);
    const Tensor result = new_tensor({in.views, in.raster.size(1), in.raster.size(2), in.channels});
    float* out = mutable_floats(result);
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
    constexpr const char* operation = "antialias backward";
    const Inputs in(operation, image, raster, positions, triangles, neighbours, max_steps,
                    bottom_up);
    const Sizes sizes{in.views, in.raster.size(1), in.raster.size(2), in.channels};
    const Tensor gradient = checked(operation, "gradient", gradient_, ScalarType::Float, sizes);
    const Tensor by_image = new_tensor(sizes);
    const auto found = in.positions.sizes();
    const Tensor by_positions =
        positions_wanted ? new_zeros(Sizes(found.begin(), found.end())) : new_tensor({0});
    const float* by_result = floats(gradient);
    float* by_colors = mutable_floats(by_image);
    std::copy_n(by_result, in.image.numel(), by_colors);
    for_each_crossing(in, [&](const kernels::AntialiasParameters& one, std::int64_t view,
                              const kernels::Crossing& crossing) {
        Accumulator sums;
        if (positions_wanted) sums.values = mutable_floats(by_positions) + view * in.view_stride;
        const std::int64_t first = view * in.per_view * in.channels;
        kernels::blend_crossing_backward(one, crossing, floats(in.image) + first, by_result + first,
                                         in.channels, by_colors + first, sums);
    });
    if (positions_wanted)
        turn_gradient(mutable_floats(by_positions), by_positions.numel(), bottom_up);
    return {by_image, by_positions};
}

}  // namespace item3d::python
