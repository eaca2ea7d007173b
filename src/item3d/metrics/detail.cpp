#include "item3d/metrics/detail.h"

#include "item3d/core/error.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"

#include <cmath>

namespace item3d {

namespace {

constexpr double min_deviation = 1e-3;

/// Returns L* / 100, [N, 1, H, W], of sRGB images [N, 3, H, W].
at::Tensor lightness(const at::Tensor& images) {
    const at::Tensor linear = srgb_to_linear(images.to(at::kFloat).clamp(0, 1)).to(at::kDouble);
    const at::Tensor y = 0.2126729 * linear.narrow(1, 0, 1) + 0.7151522 * linear.narrow(1, 1, 1) +
                         0.0721750 * linear.narrow(1, 2, 1);
    constexpr double threshold = 216.0 / 24389.0;
    return at::where(y > threshold, 1.16 * y.clamp_min(threshold).pow(1.0 / 3) - 0.16,
                     y * (24389.0 / 2700.0));
}

/// Returns a matrix [size, size] that blurs a column of `size` values, with zeros beyond its ends.
/// A matrix product is many times faster than a convolution, which copies each row once per weight.
at::Tensor blur_matrix(std::int64_t size, double sigma) {
    const at::Tensor place = at::arange(size, at::kDouble);
    const at::Tensor distance = place.unsqueeze(1) - place.unsqueeze(0);
    return at::exp(-distance.square() / (2 * sigma * sigma))
        .masked_fill(distance.abs() > std::ceil(3 * sigma), 0);
}

at::Tensor blur(const at::Tensor& images, double sigma) {
    return at::matmul(at::matmul(blur_matrix(images.size(2), sigma), images),
                      blur_matrix(images.size(3), sigma));
}

/// Returns the detail (see detail_correlation()) at the P pixels inside the mask, with zero mean.
at::Tensor detail(const at::Tensor& images, const at::Tensor& mask, double sigma) {
    ITEM3D_CHECK(images.dim() == 4 && images.size(1) == 3, "images must be [N, 3, H, W]");
    ITEM3D_CHECK(mask.dim() == 3 && mask.size(0) == images.size(0) &&
                     mask.size(1) == images.size(2) && mask.size(2) == images.size(3),
                 "the mask must be [N, H, W] like its images");
    ITEM3D_CHECK(sigma > 0, "sigma must be positive");
    const at::NoGradGuard no_gradients;
    const at::Tensor inside = (mask.detach().cpu() > 0.5).unsqueeze(1);
    const at::Tensor weight = inside.to(at::kDouble);
    const at::Tensor l = lightness(images.detach().cpu()) * weight;
    // Normalised convolution: pixels outside the mask have no weight.
    const at::Tensor mean = blur(l, sigma) / blur(weight, sigma).clamp_min(1e-9);
    const at::Tensor values = (l - mean).masked_select(inside);
    return values.numel() > 0 ? values - values.mean() : values;
}

double deviation(const at::Tensor& values) {
    return values.numel() > 0 ? std::sqrt(values.square().mean().item<double>()) : 0.0;
}

}  // namespace

double detail_correlation(const at::Tensor& before, const at::Tensor& after, const at::Tensor& mask,
                          double sigma) {
    ITEM3D_CHECK(before.sizes() == after.sizes(), "both image sets must be of one shape");
    const at::Tensor a = detail(before, mask, sigma);
    const at::Tensor b = detail(after, mask, sigma);
    const double deviation_a = deviation(a);
    const double deviation_b = deviation(b);
    if (deviation_a < min_deviation || deviation_b < min_deviation) return 0;
    return (a * b).mean().item<double>() / (deviation_a * deviation_b);
}

double detail_strength(const at::Tensor& images, const at::Tensor& mask, double sigma) {
    return deviation(detail(images, mask, sigma));
}

}  // namespace item3d
