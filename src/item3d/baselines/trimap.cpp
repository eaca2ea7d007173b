#include "item3d/baselines/trimap.h"

#include <cmath>

namespace item3d {
namespace {

constexpr double better = 0.2;  ///< minimum difference of cosines of a better view
constexpr int published_size = 1200;

/// Returns a separable, normalised Gaussian blur with zeros outside of the image.
at::Tensor gaussian(const at::Tensor& mask, int width, double sigma) {
    const at::Tensor x = at::arange(width, mask.options()) - (width - 1) / 2.0;
    at::Tensor kernel = (x.square() / (-2 * sigma * sigma)).exp();
    kernel = kernel / kernel.sum();
    const std::int64_t half = width / 2;
    const at::Tensor rows = at::conv2d(mask, kernel.view({1, 1, 1, width}), {},
                                       at::IntArrayRef({1, 1}), at::IntArrayRef({0, half}));
    return at::conv2d(rows, kernel.view({1, 1, width, 1}), {}, at::IntArrayRef({1, 1}),
                      at::IntArrayRef({half, 0}));
}

}  // namespace

int scaled_width(int published, std::int64_t size) {
    const double width =
        static_cast<double>(published) * static_cast<double>(size) / published_size;
    return 2 * static_cast<int>(std::lround((width - 1) / 2)) + 1;
}

at::Tensor dilate(const at::Tensor& mask, int width) {
    if (width <= 1) return mask;
    return at::max_pool2d(mask, {width, width}, {1, 1}, {width / 2, width / 2});
}

at::Tensor erode(const at::Tensor& mask, int width) {
    return 1 - dilate(1 - mask, width);
}

Trimap make_trimap(const TrimapInput& input) {
    const std::int64_t size = input.covered.size(3);
    const int opening = scaled_width(5, size);
    Trimap map;
    map.generate =
        dilate(input.unpainted * input.editable, scaled_width(19, size)) * input.editable;
    const at::Tensor seen_better =
        (input.cosine > input.best + better).to(at::kFloat) * (input.best > 0) * input.editable;
    map.refine = dilate(erode(seen_better, opening), opening) * (1 - map.generate) * input.editable;
    map.keep = input.editable * (1 - map.generate) * (1 - map.refine);
    // Outside of the eroded model, update has only generated pixels, which include the outline.
    const at::Tensor outside = 1 - erode(input.covered, scaled_width(7, size));
    const at::Tensor both = at::maximum(map.generate, map.refine);
    map.update = both * (1 - outside * (1 - map.generate));
    return map;
}

at::Tensor projection_mask(const TrimapInput& input, const at::Tensor& update) {
    const std::int64_t size = input.covered.size(3);
    const at::Tensor inner = erode(input.covered, scaled_width(5, size));
    const at::Tensor mask = inner * dilate(update, scaled_width(25, size)) * input.editable;
    const int width = scaled_width(21, size);
    const at::Tensor soft =
        gaussian(mask, width, 16.0 * static_cast<double>(size) / published_size);
    const at::Tensor strict = at::where(soft < 0.5, 0.0, soft) * mask;
    return strict * (input.cosine + better >= input.best);
}

}  // namespace item3d
