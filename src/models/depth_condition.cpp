#include "item3d/models/depth_condition.h"

#include "item3d/core/error.h"

#include <limits>

namespace item3d {
namespace {

/// [N, 1, H, W] disparity, scaled an image to 0.2 (far) .. 1 (near).
torch::Tensor relative_disparity(const torch::Tensor& depth, double background) {
    ITEM3D_CHECK(depth.dim() == 3, "depth must be [N, H, W]");
    const float infinity = std::numeric_limits<float>::infinity();
    const torch::Tensor covered = depth > 0;
    const torch::Tensor disparity = torch::where(covered, 1 / depth.clamp_min(1e-6), 0.0);
    const torch::Tensor near = disparity.amax({1, 2}, true);
    const torch::Tensor far =
        disparity.masked_fill(covered.logical_not(), infinity).amin({1, 2}, true);
    const torch::Tensor relative = (disparity - far) / (near - far).clamp_min(1e-6);
    return torch::where(covered, 0.2 + 0.8 * relative, background).unsqueeze(1);
}

}  // namespace

torch::Tensor depth_condition(const torch::Tensor& depth, int downscale) {
    const torch::NoGradGuard no_grad;
    return torch::avg_pool2d(relative_disparity(depth, -1.0), downscale, downscale, 0,
                             /*ceil_mode=*/true);
}

torch::Tensor depth_picture(const torch::Tensor& depth, std::int64_t height, std::int64_t width) {
    const torch::NoGradGuard no_grad;
    return torch::adaptive_avg_pool2d(relative_disparity(depth, 0.0), {height, width})
        .expand({-1, 3, -1, -1});
}

bool takes_depth(const Pipeline& pipeline) {
    return !pipeline.controlnet.is_empty() || pipeline.condition_channels() == 1;
}

torch::Tensor condition_of_depth(const Pipeline& pipeline, const torch::Tensor& depth,
                                 const torch::Tensor& latents) {
    if (!takes_depth(pipeline)) return {};
    ITEM3D_CHECK(depth.defined(), "this prior takes depth, and none was given");
    const std::int64_t height = latents.size(2), width = latents.size(3);
    if (!pipeline.controlnet.is_empty()) {
        const int pixels = pipeline.controlnet->config().downscale();
        return depth_picture(depth, height * pixels, width * pixels).to(latents.device());
    }
    return depth_condition(depth, static_cast<int>(depth.size(1) / height)).to(latents.device());
}

}  // namespace item3d
