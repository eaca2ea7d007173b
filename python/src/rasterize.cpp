#include "python/src/rasterize.h"

#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/raster_bands.h"
#include "python/src/value_checks.h"

#include <algorithm>
#include <string>

namespace item3d::python {
namespace {

/// Returns the ranges, in the CPU's memory.
Tensor checked_ranges(const Operation& call, const Tensor& tensor, std::int64_t triangles) {
    const Tensor ranges =
        Operation("rasterize", tensor).checked("ranges", tensor, ScalarType::Int, {-1, 2});
    const Tensor on_cpu = call.on_cpu(ranges);
    const std::int32_t* range = integers(on_cpu);
    for (std::int64_t view = 0; view < ranges.size(0); ++view) {
        const std::int64_t first = range[2 * view], count = range[2 * view + 1];
        if (first < 0 || count < 0 || first + count > triangles)
            call.fail("ranges must lie in the " + std::to_string(triangles) +
                      " triangles, found first " + std::to_string(first) + ", count " +
                      std::to_string(count) + " for view " + std::to_string(view));
    }
    return on_cpu;
}

/// Rasterizes on the call's device. On the CPU, the outputs are those of an empty image initially.
void draw(const Operation& call, const kernels::RasterParameters& p, std::int64_t views) {
    if (!call.on_device()) {
        rasterize_on_cpu(p, views);
        return;
    }
    const std::int64_t triangles = views * p.triangle_count;
    const std::int64_t pixels = views * p.width * p.height;
    const Tensor keys = call.zeros({pixels}, ScalarType::Long);
    const kernels::KeyedRasterParameters keyed{
        p, static_cast<unsigned long long*>(keys.mutable_data_ptr()), views,
        kernels::key_bands(triangles, p.height)};
    using Table = cuda::RenderTable;
    call.launch(&Table::bound_triangles, p, triangles);
    call.launch(&Table::rasterize_keys, keyed, triangles * keyed.bands);
    call.launch(&Table::resolve_keys, keyed, pixels);
}

}  // namespace

std::tuple<Tensor, Tensor> rasterize(const Tensor& positions_, const Tensor& triangles_,
                                     const std::optional<Tensor>& ranges_,
                                     const std::optional<Tensor>& behind_, std::int64_t height,
                                     std::int64_t width, bool by_w, bool bottom_up, bool slopes,
                                     bool finite) {
    const Operation call("rasterize", positions_);
    if (height < 1 || width < 1 || height > 16384 || width > 16384)
        call.fail("height and width must be in [1, 16384], found " + std::to_string(height) +
                  " and " + std::to_string(width));
    const Tensor positions = call.checked("positions", positions_, ScalarType::Float,
                                          ranges_ ? Sizes{-1, 4} : Sizes{-1, -1, 4});
    const Tensor triangles = call.checked("triangles", triangles_, ScalarType::Int, {-1, 3});
    const std::int64_t vertices = positions.size(ranges_ ? 0 : 1);
    const std::int64_t triangle_count = triangles.size(0);
    ValueChecks checks(call, Pass::forward);
    checks.indices(triangles, vertices);
    if (triangle_count > kernels::max_float_triangles)
        call.fail("at most 16777215 triangles, found " + std::to_string(triangle_count));
    const Tensor ranges = ranges_ ? checked_ranges(call, *ranges_, triangle_count) : Tensor();
    const std::int64_t views = ranges_ ? ranges.size(0) : positions.size(0);
    const Tensor behind =
        behind_ ? call.checked("behind", *behind_, ScalarType::Float, {views, height, width})
                : Tensor();
    if (finite)
        checks.finite("positions", positions, [&](std::int64_t index) {
            const Tensor values = call.on_cpu(positions);
            const std::int64_t vertex = index / 4;
            return "positions must be finite, found " + std::to_string(floats(values)[index]) +
                   " in vertex " + std::to_string(vertex % vertices) + " of view " +
                   std::to_string(vertex / vertices);
        });
    checks.finish();

    const std::int64_t per_view = height * width, pixels = views * per_view;
    const Tensor turned = call.upside_down(positions, bottom_up);
    const auto barycentrics = call.scratch<float>(2 * pixels);
    const auto depth = call.scratch<float>(pixels);
    const auto triangle = call.scratch<std::int32_t>(pixels);
    if (!call.on_device()) {
        std::fill_n(depth.data(), pixels, 0.0f);
        std::fill_n(triangle.data(), pixels, -1);
    }
    const auto boxes = call.scratch<kernels::PixelBox>((ranges_ ? 1 : views) * triangle_count);
    kernels::RasterParameters p{floats(turned),
                                integers(triangles),
                                boxes.data(),
                                vertices,
                                triangle_count,
                                static_cast<int>(width),
                                static_cast<int>(height),
                                barycentrics.data(),
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
            draw(call, one, 1);
        }
    } else if (views > 0) {
        draw(call, p, views);
    }

    using Table = cuda::RenderTable;
    const Tensor raster = call.empty({views, height, width, 4});
    const Tensor first =
        ranges_ ? call.upload(integers(ranges), ranges.numel(), ScalarType::Int) : Tensor();
    call.run<kernels::pack_raster>(&Table::pack_raster,
                                   kernels::PackParameters{p.barycentrics, p.depth, p.triangle,
                                                           ranges_ ? integers(first) : nullptr,
                                                           per_view, mutable_floats(raster)},
                                   pixels, 16384);
    const Tensor by_pixel = call.empty({views, height, width, slopes ? 4 : 0});
    if (slopes) {
        kernels::RasterSlopeParameters s{};
        s.positions_clip = p.positions_clip;
        s.view_stride = ranges_ ? 0 : 4 * vertices;
        s.triangles = p.triangles;
        s.raster = floats(raster);
        s.width = p.width;
        s.height = p.height;
        s.slopes = mutable_floats(by_pixel);
        call.run<kernels::raster_slopes>(&Table::raster_slopes, s, pixels);
    }
    return {raster, by_pixel};
}

Tensor rasterize_backward(const Tensor& positions_, const Tensor& triangles_, const Tensor& raster_,
                          const Tensor& raster_gradient_,
                          const std::optional<Tensor>& slope_gradient_, bool bottom_up) {
    const Operation call("rasterize backward", positions_);
    const bool ranges = positions_.dim() == 2;
    const Tensor positions = call.checked("positions", positions_, ScalarType::Float,
                                          ranges ? Sizes{-1, 4} : Sizes{-1, -1, 4});
    const Tensor triangles = call.checked("triangles", triangles_, ScalarType::Int, {-1, 3});
    const Tensor raster = call.checked("raster", raster_, ScalarType::Float, {-1, -1, -1, 4});
    const Sizes sizes = sizes_of(raster);
    const Tensor raster_gradient =
        call.checked("gradient", raster_gradient_, ScalarType::Float, sizes);
    const Tensor slope_gradient =
        slope_gradient_ ? call.checked("slope gradient", *slope_gradient_, ScalarType::Float, sizes)
                        : Tensor();
    const Tensor turned = call.upside_down(positions, bottom_up);
    kernels::RasterSlopeParameters p{};
    p.positions_clip = floats(turned);
    p.view_stride = ranges ? 0 : 4 * positions.size(1);
    p.triangles = integers(triangles);
    p.raster = floats(raster);
    p.width = static_cast<int>(sizes[2]);
    p.height = static_cast<int>(sizes[1]);
    p.raster_gradient = floats(raster_gradient);
    p.slope_gradient = slope_gradient_ ? floats(slope_gradient) : nullptr;
    const std::int64_t pixels = sizes[0] * sizes[1] * sizes[2];
    const Tensor gradient = call.sum(
        pixels, sizes_of(positions),
        [&](std::int64_t pixel, const Accumulator& sums) {
            kernels::raster_backward(p, pixel, sums);
        },
        [&](const Accumulator& sums) {
            call.launch(&cuda::RenderTable::raster_backward, {p, sums}, pixels);
        });
    return call.upside_down(gradient, bottom_up);
}

}  // namespace item3d::python
