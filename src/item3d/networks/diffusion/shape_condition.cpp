#include "item3d/networks/diffusion/shape_condition.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace item3d {
namespace {

/// Of a shape some 12 latent cells wide, that is two units, the finest wave has two cells.
constexpr std::array<float, space_waves> cycles_a_unit{0.5f, 1, 2, 3};
/// Along both axes.
constexpr std::array<std::array<float, 2>, plane_waves> plane_cycles{{{1, 0},
                                                                      {0, 1},
                                                                      {1, 1},
                                                                      {1, -1},
                                                                      {2, 0},
                                                                      {0, 2},
                                                                      {2, 1},
                                                                      {2, -1},
                                                                      {2, 2},
                                                                      {2, -2},
                                                                      {3, 0},
                                                                      {0, 3}}};

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

/// [N, 1, h, w] each: those of the position [N, 3, h, w] on the plane that the normal faces most.
std::pair<torch::Tensor, torch::Tensor> plane_coordinates(const torch::Tensor& position,
                                                          const torch::Tensor& normal) {
    const auto channel = [](const torch::Tensor& of, int c) { return of.slice(1, c, c + 1); };
    const torch::Tensor facing = normal.abs();
    const torch::Tensor x = channel(facing, 0), y = channel(facing, 1), z = channel(facing, 2);
    const torch::Tensor faces_x = (x >= y).logical_and(x >= z);
    const torch::Tensor faces_y = faces_x.logical_not().logical_and(y >= z);
    return {torch::where(faces_x, channel(position, 2), channel(position, 0)),
            torch::where(faces_y, channel(position, 2), channel(position, 1))};
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
    const auto add_wave = [&](const torch::Tensor& cycles) {
        all.push_back((2 * pi * cycles).sin() * covered);
        all.push_back((2 * pi * cycles).cos() * covered);
    };
    for (const float cycles : cycles_a_unit)
        add_wave(cells.slice(1, 1, 4) * cycles);
    const auto [u, v] = plane_coordinates(cells.slice(1, 1, 4), cells.slice(1, 4));
    for (const auto& [along_u, along_v] : plane_cycles)
        add_wave(u * along_u + v * along_v);
    return torch::cat(all, 1);
}

bool takes_shape(const Pipeline& pipeline) {
    const int channels = pipeline.condition_channels();
    return !pipeline.controlnet.is_empty() || channels == 1 ||
           channels == surface_condition_channels;
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
    if (pipeline.condition_channels() == 1)
        return depth_condition(shape.depth, downscale).to(latents.device());
    return shape_condition(shape_cells(shape, downscale), pipeline.condition_channels())
        .to(latents.device());
}

}  // namespace item3d
