#include "python/src/interpolate.h"

#include "item3d/render/kernels/pixel_raster.h"
#include "python/src/value_checks.h"

#include <algorithm>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    Tensor attributes, raster, triangles, slopes, channels;
    std::int64_t views, height, width, pixels;
    kernels::PixelAttributeParameters p{};

    Inputs(const Operation& call, Pass pass, const Tensor& attributes_, const Tensor& raster_,
           const Tensor& triangles_, const std::optional<Tensor>& slopes_,
           const std::vector<std::int64_t>& sloped)
        : raster(call.checked("raster", raster_, ScalarType::Float, {-1, -1, -1, 4})),
          triangles(call.checked("triangles", triangles_, ScalarType::Int, {-1, 3})),
          views(raster.size(0)),
          height(raster.size(1)),
          width(raster.size(2)),
          pixels(views * height * width) {
        const bool each = attributes_.dim() == 3 && attributes_.size(0) != 1;
        attributes =
            call.checked("attributes", attributes_, ScalarType::Float,
                         attributes_.dim() == 3 ? Sizes{each ? views : 1, -1, -1} : Sizes{-1, -1});
        const std::int64_t vertices = attributes.size(attributes.dim() - 2);
        ValueChecks checks(call, pass);
        checks.indices(triangles, vertices);
        checks.raster(raster, triangles.size(0));
        checks.finish();
        p.attributes = floats(attributes);
        p.channels = static_cast<int>(attributes.size(attributes.dim() - 1));
        p.view_stride = each ? vertices * p.channels : 0;
        p.pixels_per_view = std::max<std::int64_t>(1, height * width);
        p.triangles = integers(triangles);
        p.raster = floats(raster);
        if (!slopes_) return;
        slopes =
            call.checked("derivatives", *slopes_, ScalarType::Float, {views, height, width, 4});
        for (const std::int64_t channel : sloped)
            if (channel < 0 || channel >= p.channels)
                call.fail("channels must be in [0, " + std::to_string(p.channels) + "), found " +
                          std::to_string(channel));
        p.slopes = floats(slopes);
        p.sloped_count = static_cast<int>(sloped.size());
        channels = call.upload(sloped.data(), p.sloped_count, ScalarType::Long);
        p.sloped = static_cast<const std::int64_t*>(channels.const_data_ptr());
    }
};

}  // namespace

std::tuple<Tensor, Tensor> interpolate(const Tensor& attributes, const Tensor& raster,
                                       const Tensor& triangles, const std::optional<Tensor>& slopes,
                                       const std::vector<std::int64_t>& sloped) {
    const Operation call("interpolate", raster);
    const Inputs in(call, Pass::forward, attributes, raster, triangles, slopes, sloped);
    kernels::PixelAttributeParameters p = in.p;
    const Tensor values = call.empty({in.views, in.height, in.width, p.channels});
    const Tensor value_slopes = call.empty({in.views, in.height, in.width, 2 * p.sloped_count});
    p.values = mutable_floats(values);
    p.value_slopes = mutable_floats(value_slopes);
    call.run<kernels::pixel_attributes>(&Table::pixel_attributes, p, in.pixels);
    return {values, value_slopes};
}

std::tuple<Tensor, Tensor, Tensor> interpolate_backward(
    const Tensor& attributes, const Tensor& raster, const Tensor& triangles,
    const std::optional<Tensor>& slopes, const std::vector<std::int64_t>& sloped,
    const Tensor& value_gradient_, const Tensor& value_slope_gradient_, bool attributes_wanted) {
    const Operation call("interpolate backward", raster);
    const Inputs in(call, Pass::backward, attributes, raster, triangles, slopes, sloped);
    kernels::PixelAttributeParameters p = in.p;
    const Tensor value_gradient = call.checked("gradient", value_gradient_, ScalarType::Float,
                                               {in.views, in.height, in.width, p.channels});
    const Tensor value_slope_gradient =
        call.checked("gradient of derivatives", value_slope_gradient_, ScalarType::Float,
                     {in.views, in.height, in.width, 2 * p.sloped_count});
    const Sizes sizes{in.views, in.height, in.width, 4};
    const Tensor by_raster = call.empty(sizes);
    const Tensor by_slopes = slopes ? call.empty(sizes) : call.empty({0});
    p.value_gradient = floats(value_gradient);
    p.value_slope_gradient = floats(value_slope_gradient);
    p.raster_gradient = mutable_floats(by_raster);
    p.slope_gradient = slopes ? mutable_floats(by_slopes) : nullptr;
    const auto visit = [&](std::int64_t pixel, const Accumulator& sums) {
        kernels::pixel_attributes_backward(p, pixel, sums);
    };
    const auto launch = [&](const Accumulator& sums) {
        call.launch(&Table::pixel_attributes_backward, {p, sums}, in.pixels);
    };
    if (attributes_wanted)
        return {call.sum(in.pixels, sizes_of(in.attributes), visit, launch), by_raster, by_slopes};
    call.visit(in.pixels, visit, launch);
    return {call.empty({0}), by_raster, by_slopes};
}

}  // namespace item3d::python
