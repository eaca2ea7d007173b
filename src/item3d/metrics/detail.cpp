#include "item3d/metrics/detail.h"

#include "item3d/core/error.h"
#include "item3d/render/shade.h"

#include <cmath>

namespace item3d {

namespace {

constexpr double least_deviation = 1e-3;

/// L* / 100 of [N, 3, H, W] sRGB -> [N, 1, H, W].
torch::Tensor lightness(const torch::Tensor& images) {
    const torch::Tensor linear = srgb_to_linear(images.to(torch::kFloat64).clamp(0, 1));
    const torch::Tensor y = 0.2126729 * linear.narrow(1, 0, 1) +
                            0.7151522 * linear.narrow(1, 1, 1) + 0.0721750 * linear.narrow(1, 2, 1);
    constexpr double threshold = 216.0 / 24389.0;
    return torch::where(y > threshold, 1.16 * y.clamp_min(threshold).pow(1.0 / 3) - 0.16,
                        y * (24389.0 / 2700.0));
}

/// [size, size]: blurs a column of so many values, with nothing beyond its ends. As a matrix
/// product it is many times quicker than as a convolution, which copies each row once for each
/// weight.
torch::Tensor blur_matrix(std::int64_t size, double sigma) {
    const torch::Tensor place = torch::arange(size, torch::kFloat64);
    const torch::Tensor distance = place.unsqueeze(1) - place.unsqueeze(0);
    return torch::exp(-distance.square() / (2 * sigma * sigma))
        .masked_fill(distance.abs() > std::ceil(3 * sigma), 0);
}

torch::Tensor blur(const torch::Tensor& images, double sigma) {
    return torch::matmul(torch::matmul(blur_matrix(images.size(2), sigma), images),
                         blur_matrix(images.size(3), sigma));
}

/// The detail at the P pixels inside the mask, zero mean.
torch::Tensor detail(const torch::Tensor& images, const torch::Tensor& mask, double sigma) {
    ITEM3D_CHECK(images.dim() == 4 && images.size(1) == 3, "images must be [N, 3, H, W]");
    ITEM3D_CHECK(mask.dim() == 3 && mask.size(0) == images.size(0) &&
                     mask.size(1) == images.size(2) && mask.size(2) == images.size(3),
                 "the mask must be [N, H, W] like its images");
    ITEM3D_CHECK(sigma > 0, "sigma must be positive");
    const torch::NoGradGuard no_gradients;
    const torch::Tensor inside = (mask.detach().cpu() > 0.5).unsqueeze(1);
    const torch::Tensor weight = inside.to(torch::kFloat64);
    const torch::Tensor l = lightness(images.detach().cpu()) * weight;
    // Normalised convolution: what lies outside the mask counts nothing.
    const torch::Tensor mean = blur(l, sigma) / blur(weight, sigma).clamp_min(1e-9);
    const torch::Tensor values = (l - mean).masked_select(inside);
    return values.numel() > 0 ? values - values.mean() : values;
}

double deviation(const torch::Tensor& values) {
    return values.numel() > 0 ? std::sqrt(values.square().mean().item<double>()) : 0.0;
}

}  // namespace

double detail_correlation(const torch::Tensor& before, const torch::Tensor& after,
                          const torch::Tensor& mask, double sigma) {
    ITEM3D_CHECK(before.sizes() == after.sizes(), "both image sets must be of one shape");
    const torch::Tensor a = detail(before, mask, sigma);
    const torch::Tensor b = detail(after, mask, sigma);
    const double deviation_a = deviation(a);
    const double deviation_b = deviation(b);
    if (deviation_a < least_deviation || deviation_b < least_deviation) return 0;
    return (a * b).mean().item<double>() / (deviation_a * deviation_b);
}

double detail_strength(const torch::Tensor& images, const torch::Tensor& mask, double sigma) {
    return deviation(detail(images, mask, sigma));
}

}  // namespace item3d
