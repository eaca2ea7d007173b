#include "python/src/interpolate.h"

#include "item3d/render/kernels/pixel_raster.h"

#include <atomic>

namespace item3d::python {
namespace {

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    Tensor attributes, raster, triangles, slopes;
    std::int64_t views, height, width, pixels;
    kernels::PixelAttributeParameters p{};

    Inputs(const char* operation, const Tensor& attributes_, const Tensor& raster_,
           const Tensor& triangles_, const std::optional<Tensor>& slopes_,
           const std::vector<std::int64_t>& sloped)
        : raster(checked(operation, "raster", raster_, ScalarType::Float, {-1, -1, -1, 4})),
          triangles(checked(operation, "triangles", triangles_, ScalarType::Int, {-1, 3})),
          views(raster.size(0)),
          height(raster.size(1)),
          width(raster.size(2)),
          pixels(views * height * width) {
        const bool each = attributes_.dim() == 3 && attributes_.size(0) != 1;
        attributes =
            checked(operation, "attributes", attributes_, ScalarType::Float,
                    attributes_.dim() == 3 ? Sizes{each ? views : 1, -1, -1} : Sizes{-1, -1});
        const std::int64_t vertices = attributes.size(attributes.dim() - 2);
        check_indices(operation, triangles, vertices);
        p.attributes = floats(attributes);
        p.channels = static_cast<int>(attributes.size(attributes.dim() - 1));
        p.view_stride = each ? vertices * p.channels : 0;
        p.pixels_per_view = std::max<std::int64_t>(1, height * width);
        p.triangles = integers(triangles);
        p.raster = floats(raster);
        if (!slopes_) return;
        slopes = checked(operation, "derivatives", *slopes_, ScalarType::Float,
                         {views, height, width, 4});
        for (const std::int64_t channel : sloped)
            if (channel < 0 || channel >= p.channels)
                fail(operation, "channels must be in [0, " + std::to_string(p.channels) +
                                    "), found " + std::to_string(channel));
        p.slopes = floats(slopes);
        p.sloped = sloped.data();
        p.sloped_count = static_cast<int>(sloped.size());
    }

    /// Calls f(pixel) on all threads. Throws if the raster contains an index beyond the triangles.
    template <typename F>
    void for_each_pixel(const char* operation, const F& f) const {
        std::atomic<bool> unknown{false};
        const auto maximum = static_cast<float>(triangles.size(0));
        parallel_for(
            operation, pixels,
            [&](std::int64_t pixel) {
                if (p.raster[4 * pixel + 3] > maximum)
                    unknown = true;
                else
                    f(pixel);
            },
            4096);
        if (unknown)
            fail(operation, "raster names triangles beyond the " +
                                std::to_string(triangles.size(0)) + " that are given");
    }
};

}  // namespace

std::tuple<Tensor, Tensor> interpolate(const Tensor& attributes, const Tensor& raster,
                                       const Tensor& triangles, const std::optional<Tensor>& slopes,
                                       const std::vector<std::int64_t>& sloped) {
    constexpr const char* operation = "interpolate";
    const Inputs in(operation, attributes, raster, triangles, slopes, sloped);
    kernels::PixelAttributeParameters p = in.p;
    const Tensor values = new_tensor({in.views, in.height, in.width, p.channels});
    const Tensor value_slopes = new_tensor({in.views, in.height, in.width, 2 * p.sloped_count});
    p.values = mutable_floats(values);
    p.value_slopes = mutable_floats(value_slopes);
    in.for_each_pixel(operation, [&](std::int64_t pixel) { kernels::pixel_attributes(p, pixel); });
    return {values, value_slopes};
}

std::tuple<Tensor, Tensor, Tensor> interpolate_backward(
    const Tensor& attributes, const Tensor& raster, const Tensor& triangles,
    const std::optional<Tensor>& slopes, const std::vector<std::int64_t>& sloped,
    const Tensor& value_gradient_, const Tensor& value_slope_gradient_, bool attributes_wanted) {
    constexpr const char* operation = "interpolate backward";
    const Inputs in(operation, attributes, raster, triangles, slopes, sloped);
    kernels::PixelAttributeParameters p = in.p;
    const Tensor value_gradient = checked(operation, "gradient", value_gradient_, ScalarType::Float,
                                          {in.views, in.height, in.width, p.channels});
    const Tensor value_slope_gradient =
        checked(operation, "gradient of derivatives", value_slope_gradient_, ScalarType::Float,
                {in.views, in.height, in.width, 2 * p.sloped_count});
    const Sizes sizes{in.views, in.height, in.width, 4};
    const Tensor by_raster = new_tensor(sizes);
    const Tensor by_slopes = slopes ? new_tensor(sizes) : new_tensor({0});
    p.value_gradient = floats(value_gradient);
    p.value_slope_gradient = floats(value_slope_gradient);
    p.raster_gradient = mutable_floats(by_raster);
    p.slope_gradient = slopes ? mutable_floats(by_slopes) : nullptr;
    if (!attributes_wanted) {
        in.for_each_pixel(operation, [&](std::int64_t pixel) {
            kernels::pixel_attributes_backward(p, pixel, {});
        });
        return {new_tensor({0}), by_raster, by_slopes};
    }
    const auto found = in.attributes.sizes();
    const Tensor by_attributes = new_zeros(Sizes(found.begin(), found.end()));
    sum_pixels(in.pixels, in.attributes.numel(), mutable_floats(by_attributes),
               [&](std::int64_t pixel, const Accumulator& sums) {
                   kernels::pixel_attributes_backward(p, pixel, sums);
               });
    return {by_attributes, by_raster, by_slopes};
}

}  // namespace item3d::python
