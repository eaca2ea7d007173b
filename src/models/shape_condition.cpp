#include "item3d/models/shape_condition.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"

#include <array>
#include <limits>
#include <vector>

namespace item3d {
namespace {

/// Of a shape some 12 latent cells wide, that is two units, the finest wave has two cells.
constexpr std::array<double, position_waves> cycles_a_unit{0.5, 1, 2, 3};

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

torch::Tensor shape_cells(const SeenShape& shape, int downscale) {
    const torch::NoGradGuard no_grad;
    const torch::Tensor covered = (shape.depth > 0).to(torch::kFloat32).unsqueeze(1);
    const auto cells = [&](const torch::Tensor& pixels) {
        return torch::avg_pool2d(pixels, downscale, downscale, 0, /*ceil_mode=*/true);
    };
    const torch::Tensor share = cells(covered).clamp_min(1e-6);
    const auto mean = [&](const torch::Tensor& values) {
        return cells(values.permute({0, 3, 1, 2}) * covered) / share;
    };
    return torch::cat(
        {depth_condition(shape.depth, downscale), mean(shape.position), mean(shape.normal)}, 1);
}

torch::Tensor shape_condition(const torch::Tensor& cells, int channels) {
    const torch::NoGradGuard no_grad;
    if (channels == 0) return {};
    const torch::Tensor depth = cells.slice(1, 0, 1);
    if (channels == 1) return depth;
    ITEM3D_CHECK(channels == surface_condition_channels, "no condition has so many channels");
    const torch::Tensor covered = depth > -1;
    std::vector<torch::Tensor> all{depth, cells.slice(1, 4)};
    for (const double cycles : cycles_a_unit) {
        const torch::Tensor phase = cells.slice(1, 1, 4) * (2 * pi * cycles);
        all.push_back(phase.sin() * covered);
        all.push_back(phase.cos() * covered);
    }
    return torch::cat(all, 1);
}

bool takes_shape(const Pipeline& pipeline) {
    return !pipeline.controlnet.is_empty() || pipeline.condition_channels() > 0;
}

torch::Tensor condition_of_shape(const Pipeline& pipeline, const SeenShape& shape,
                                 const torch::Tensor& latents) {
    if (!takes_shape(pipeline)) return {};
    ITEM3D_CHECK(shape.depth.defined(), "this prior takes a shape, and none was given");
    const std::int64_t height = latents.size(2), width = latents.size(3);
    if (!pipeline.controlnet.is_empty()) {
        const int pixels = pipeline.controlnet->config().downscale();
        return depth_picture(shape.depth, height * pixels, width * pixels).to(latents.device());
    }
    const auto downscale = static_cast<int>(shape.depth.size(1) / height);
    return shape_condition(shape_cells(shape, downscale), pipeline.condition_channels())
        .to(latents.device());
}

}  // namespace item3d
