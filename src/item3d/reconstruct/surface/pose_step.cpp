#include "item3d/reconstruct/surface/pose_step.h"

#include "item3d/reconstruct/surface/view_render.h"

namespace item3d {

namespace {

constexpr std::int64_t fewest_drawn = 64;
constexpr float grey = 0.2f;
constexpr float min_difference = 0.02f;
constexpr double damping = 0.01;  ///< relative to the mean of the normal matrix's diagonal
constexpr double largest_step = 0.01;

/// Converts an image [1, H, W, 4] for comparison. The result [H, W, 4] is the blurred image in
/// log-sRGB over grey, and its coverage.
at::Tensor compared(const at::Tensor& image) {
    const at::Tensor alpha = image.narrow(3, 3, 1);
    const at::Tensor color = log_srgb(image.narrow(3, 0, 3) + (1 - alpha) * grey);
    const at::Tensor planes = at::cat({color, alpha}, 3).permute({0, 3, 1, 2});
    return at::avg_pool2d(planes, {3, 3}, {1, 1}, {1, 1}, false, /*count_include_pad=*/false)[0]
        .permute({1, 2, 0})
        .contiguous();
}

/// Returns central differences along a dimension of [H, W, 4]; 0 at the borders.
at::Tensor slope_along(const at::Tensor& image, std::int64_t dimension) {
    at::Tensor slope = at::zeros_like(image);
    const std::int64_t inner = image.size(dimension) - 2;
    if (inner > 0)
        slope.narrow(dimension, 1, inner)
            .copy_(0.5f * (image.narrow(dimension, 2, inner) - image.narrow(dimension, 0, inner)));
    return slope;
}

/// Returns the derivative [P, 2, 3] of a pixel's column and row with respect to its surface
/// position [P, 3].
at::Tensor pixel_slopes(const Camera& camera, int width, int height, const at::Tensor& position) {
    const Mat4 clip = camera.world_to_clip(width, height);
    const auto row = [&](int r) { return at::tensor({clip[0][r], clip[1][r], clip[2][r]}); };
    const auto value = [&](int r) { return (position.matmul(row(r)) + clip[3][r]).unsqueeze(1); };
    const at::Tensor w = value(3);
    const at::Tensor column = (row(0) - value(0) / w * row(3)) / w;
    const at::Tensor upwards = (row(1) - value(1) / w * row(3)) / w;
    return at::stack(
        {0.5f * static_cast<float>(width) * column, -0.5f * static_cast<float>(height) * upwards},
        1);
}

}  // namespace

SmallMotion pose_step(const DrawnView& drawn, const at::Tensor& photograph,
                      const at::Tensor& centre, float radius) {
    const at::NoGradGuard no_gradient;
    const std::int64_t points = drawn.pixel.size(0);
    if (points < fewest_drawn) return {at::zeros({3}), at::zeros({3})};
    const at::Tensor now = compared(drawn.image), wanted = compared(photograph);
    const auto at_points = [&](const at::Tensor& image) {
        return image.reshape({-1, 4}).index_select(0, drawn.pixel);
    };
    const at::Tensor mean = 0.5f * (now + wanted);
    const at::Tensor on_image =
        at::stack({at_points(slope_along(mean, 1)), at_points(slope_along(mean, 0))}, 2);
    const int height = static_cast<int>(now.size(0)), width = static_cast<int>(now.size(1));
    // Negated derivative of each image channel at a fixed pixel with respect to the surface
    // position, [P, 4, 3].
    const at::Tensor slope =
        on_image.matmul(pixel_slopes(drawn.camera, width, height, drawn.position));
    const at::Tensor arm = (drawn.position - centre).unsqueeze(1).expand_as(slope);
    const at::Tensor jacobian =
        at::cat({at::linalg_cross(arm, slope, -1), radius * slope}, 2).reshape({-1, 6});
    const at::Tensor missing = (at_points(wanted) - at_points(now)).reshape({-1, 1});
    const at::Tensor weight = missing.abs().clamp_min(min_difference).reciprocal();
    const at::Tensor weighted = (jacobian * weight).t();
    at::Tensor normal = weighted.matmul(jacobian).to(at::kDouble);
    const at::Tensor side = -weighted.matmul(missing).to(at::kDouble);
    normal = normal + (damping * normal.diagonal().mean() + 1e-12) * at::eye(6, at::kDouble);
    at::Tensor step = at::linalg_solve(normal, side.squeeze(1));
    step = (step * (largest_step / step.abs().max().clamp_min(largest_step))).to(at::kFloat);
    return {step.narrow(0, 0, 3), step.narrow(0, 3, 3)};
}

}  // namespace item3d
