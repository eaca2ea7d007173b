#include "item3d/metrics/image_quality.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {

namespace {

constexpr int window = 11;
constexpr double window_sigma = 1.5;

/// Returns the Gaussian mean of each channel over each window inside the image.
at::Tensor windowed_mean(const at::Tensor& images, const at::Tensor& weights) {
    const std::int64_t channels = images.size(1);
    const auto kernel = [&](std::int64_t height, std::int64_t width) {
        return weights.view({1, 1, height, width}).expand({channels, 1, height, width});
    };
    const auto convolve = [&](const at::Tensor& input, const at::Tensor& weight) {
        const std::array<std::int64_t, 2> one{1, 1}, none{0, 0};
        return at::conv2d(input, weight, at::Tensor(), at::IntArrayRef(one), at::IntArrayRef(none),
                          at::IntArrayRef(one), /*groups=*/channels);
    };
    return convolve(convolve(images, kernel(1, window)), kernel(window, 1));
}

}  // namespace

double psnr(const at::Tensor& image, const at::Tensor& truth) {
    ITEM3D_CHECK(image.sizes() == truth.sizes() && image.numel() > 0, "psnr: two of one shape");
    const double error =
        (image.to(at::kDouble) - truth.to(at::kDouble)).square().mean().item<double>();
    return -10.0 * std::log10(std::max(error, 1e-10));
}

double ssim(const at::Tensor& image, const at::Tensor& truth) {
    ITEM3D_CHECK(image.dim() == 4 && image.sizes() == truth.sizes() && image.size(2) >= window &&
                     image.size(3) >= window,
                 "ssim: two of one shape [N, C, H, W], at least 11 pixels a side");
    const at::NoGradGuard no_gradient;
    const at::Tensor at = at::arange(window, image.options()) - (window - 1) / 2.0;
    at::Tensor weights = at::exp(-at.square() / (2 * window_sigma * window_sigma));
    weights = weights / weights.sum();
    const auto mean = [&](const at::Tensor& images) { return windowed_mean(images, weights); };
    const at::Tensor a = mean(image), b = mean(truth);
    const at::Tensor variance_a = mean(image.square()) - a.square();
    const at::Tensor variance_b = mean(truth.square()) - b.square();
    const at::Tensor covariance = mean(image * truth) - a * b;
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    const at::Tensor similarity = ((2 * a * b + c1) * (2 * covariance + c2)) /
                                  ((a.square() + b.square() + c1) * (variance_a + variance_b + c2));
    return similarity.mean().item<double>();
}

}  // namespace item3d
