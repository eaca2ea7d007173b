#include "python/src/rasterize.h"

#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/raster_bands.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace item3d::python {
namespace {

constexpr const char* operation = "rasterize";

void check_finite(const Tensor& positions, std::int64_t vertices) {
    const float* values = floats(positions);
    for (std::int64_t i = 0; i < positions.numel(); ++i)
        if (!std::isfinite(values[i])) {
            const std::int64_t vertex = i / 4;
            fail(operation, "positions must be finite, found " + std::to_string(values[i]) +
                                " in vertex " + std::to_string(vertex % vertices) + " of view " +
                                std::to_string(vertex / vertices));
        }
}

Tensor checked_ranges(const Tensor& tensor, std::int64_t triangles) {
    const Tensor ranges = checked(operation, "ranges", tensor, ScalarType::Int, {-1, 2});
    const std::int32_t* range = integers(ranges);
    for (std::int64_t view = 0; view < ranges.size(0); ++view) {
        const std::int64_t first = range[2 * view], count = range[2 * view + 1];
        if (first < 0 || count < 0 || first + count > triangles)
            fail(operation, "ranges must lie in the " + std::to_string(triangles) +
                                " triangles, found first " + std::to_string(first) + ", count " +
                                std::to_string(count) + " for view " + std::to_string(view));
    }
    return ranges;
}

}  // namespace

std::tuple<Tensor, Tensor> rasterize(const Tensor& positions_, const Tensor& triangles_,
                                     const std::optional<Tensor>& ranges_,
                                     const std::optional<Tensor>& behind_, std::int64_t height,
                                     std::int64_t width, bool by_w, bool bottom_up, bool slopes,
                                     bool finite) {
    if (height < 1 || width < 1 || height > 16384 || width > 16384)
        fail(operation, "height and width must be in [1, 16384], found " + std::to_string(height) +
                            " and " + std::to_string(width));
    const Tensor positions = checked(operation, "positions", positions_, ScalarType::Float,
                                     ranges_ ? Sizes{-1, 4} : Sizes{-1, -1, 4});
    const Tensor triangles = checked(operation, "triangles", triangles_, ScalarType::Int, {-1, 3});
    const std::int64_t vertices = positions.size(ranges_ ? 0 : 1);
    const std::int64_t triangle_count = triangles.size(0);
    check_indices(operation, triangles, vertices);
    if (triangle_count > kernels::max_float_triangles)
        fail(operation, "at most 16777215 triangles, found " + std::to_string(triangle_count));
    const Tensor ranges = ranges_ ? checked_ranges(*ranges_, triangle_count) : Tensor();
    const std::int64_t views = ranges_ ? ranges.size(0) : positions.size(0);
    const Tensor behind =
        behind_ ? checked(operation, "behind", *behind_, ScalarType::Float, {views, height, width})
                : Tensor();
    if (finite) check_finite(positions, vertices);

    const std::int64_t per_view = height * width, pixels = views * per_view;
    const std::vector<float> turned = upside_down(positions, bottom_up);
    const auto barycentrics =
        std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(2 * pixels));
    std::vector<float> depth(static_cast<std::size_t>(pixels));
    std::vector<std::int32_t> triangle(static_cast<std::size_t>(pixels), -1);
    std::vector<kernels::PixelBox> boxes(
        static_cast<std::size_t>((ranges_ ? 1 : views) * triangle_count));
    kernels::RasterParameters p{bottom_up ? turned.data() : floats(positions),
                                integers(triangles),
                                boxes.data(),
                                vertices,
                                triangle_count,
                                static_cast<int>(width),
                                static_cast<int>(height),
                                barycentrics.get(),
                                depth.data(),
                                triangle.data(),
                                behind_ ? floats(behind) : nullptr,
                                by_w ? kernels::DepthOrder::w : kernels::DepthOrder::z_over_w};
    if (ranges_) {
        for (std::int64_t view = 0; view < views; ++view) {
            kernels::RasterParameters one = p;
            one.triangles += 3 * static_cast<std::int64_t>(integers(ranges)[2 * view]);
            one.triangle_count = integers(ranges)[2 * view + 1];
            one.barycentrics += 2 * view * per_view;
            one.depth += view * per_view;
            one.triangle += view * per_view;
            if (behind_) one.behind += view * per_view;
            rasterize_on_cpu(one, 1);
        }
    } else if (views > 0) {
        rasterize_on_cpu(p, views);
    }

    const Tensor raster = new_tensor({views, height, width, 4});
    float* out = mutable_floats(raster);
    parallel_for(
        operation, pixels,
        [&](std::int64_t pixel) {
            const std::int32_t t = triangle[static_cast<std::size_t>(pixel)];
            if (t < 0) {
                std::fill_n(out + 4 * pixel, 4, 0.0f);
                return;
            }
            const std::int32_t first = ranges_ ? integers(ranges)[2 * (pixel / per_view)] : 0;
            out[4 * pixel] = p.barycentrics[2 * pixel];
            out[4 * pixel + 1] = p.barycentrics[2 * pixel + 1];
            out[4 * pixel + 2] = p.depth[pixel];
            out[4 * pixel + 3] = static_cast<float>(first + t + 1);
        },
        16384);
    const Tensor by_pixel = new_tensor({views, height, width, slopes ? 4 : 0});
    if (slopes) {
        kernels::RasterSlopeParameters s{};
        s.positions_clip = p.positions_clip;
        s.view_stride = ranges_ ? 0 : 4 * vertices;
        s.triangles = p.triangles;
        s.raster = out;
        s.width = p.width;
        s.height = p.height;
        s.slopes = mutable_floats(by_pixel);
        parallel_for(
            "slopes", pixels, [&](std::int64_t pixel) { kernels::raster_slopes(s, pixel); }, 4096);
    }
    return {raster, by_pixel};
}

Tensor rasterize_backward(const Tensor& positions_, const Tensor& triangles_, const Tensor& raster_,
                          const Tensor& raster_gradient_,
                          const std::optional<Tensor>& slope_gradient_, bool bottom_up) {
    constexpr const char* backward = "rasterize backward";
    const bool ranges = positions_.dim() == 2;
    const Tensor positions = checked(backward, "positions", positions_, ScalarType::Float,
                                     ranges ? Sizes{-1, 4} : Sizes{-1, -1, 4});
    const Tensor triangles = checked(backward, "triangles", triangles_, ScalarType::Int, {-1, 3});
    const Tensor raster = checked(backward, "raster", raster_, ScalarType::Float, {-1, -1, -1, 4});
    const Sizes sizes{raster.size(0), raster.size(1), raster.size(2), 4};
    const Tensor raster_gradient =
        checked(backward, "gradient", raster_gradient_, ScalarType::Float, sizes);
    const Tensor slope_gradient =
        slope_gradient_
            ? checked(backward, "slope gradient", *slope_gradient_, ScalarType::Float, sizes)
            : Tensor();
    const std::vector<float> turned = upside_down(positions, bottom_up);
    kernels::RasterSlopeParameters p{};
    p.positions_clip = bottom_up ? turned.data() : floats(positions);
    p.view_stride = ranges ? 0 : 4 * positions.size(1);
    p.triangles = integers(triangles);
    p.raster = floats(raster);
    p.width = static_cast<int>(sizes[2]);
    p.height = static_cast<int>(sizes[1]);
    p.raster_gradient = floats(raster_gradient);
    p.slope_gradient = slope_gradient_ ? floats(slope_gradient) : nullptr;
    const auto found = positions.sizes();
    const Tensor gradient = new_zeros(Sizes(found.begin(), found.end()));
    sum_pixels(sizes[0] * sizes[1] * sizes[2], positions.numel(), mutable_floats(gradient),
               [&](std::int64_t pixel, const Accumulator& sums) {
                   kernels::raster_backward(p, pixel, sums);
               });
    turn_gradient(mutable_floats(gradient), positions.numel(), bottom_up);
    return gradient;
}

}  // namespace item3d::python
