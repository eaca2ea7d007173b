#include "item3d/networks/diffusion/shape_condition.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace item3d {
namespace {

/// Frequencies in cycles per unit of length. A shape is two units, or about 12 latent cells, wide.
/// A cycle of the finest wave is therefore two cells long.
constexpr std::array<float, space_waves> cycles_a_unit{0.5f, 1, 2, 3};
/// Frequencies of each plane wave along the plane's two axes, in cycles per unit.
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

/// Returns disparity [N, 1, H, W], scaled in each image to 0.2 (far) .. 1 (near).
at::Tensor relative_disparity(const at::Tensor& depth, double background) {
    ITEM3D_CHECK(depth.dim() == 3, "depth must be [N, H, W]");
    const float infinity = std::numeric_limits<float>::infinity();
    const at::Tensor covered = depth > 0;
    const at::Tensor disparity = at::where(covered, 1 / depth.clamp_min(1e-6), 0.0);
    const at::Tensor near = disparity.amax({1, 2}, true);
    const at::Tensor far =
        disparity.masked_fill(covered.logical_not(), infinity).amin({1, 2}, true);
    const at::Tensor relative = (disparity - far) / (near - far).clamp_min(1e-6);
    return at::where(covered, 0.2 + 0.8 * relative, background).unsqueeze(1);
}

/// Projects the position [N, 3, h, w] onto the coordinate plane that is most perpendicular to the
/// normal. Returns its two coordinates there, [N, 1, h, w] each.
std::pair<at::Tensor, at::Tensor> plane_coordinates(const at::Tensor& position,
                                                    const at::Tensor& normal) {
    const auto channel = [](const at::Tensor& of, int c) { return of.slice(1, c, c + 1); };
    const at::Tensor facing = normal.abs();
    const at::Tensor x = channel(facing, 0), y = channel(facing, 1), z = channel(facing, 2);
    const at::Tensor faces_x = (x >= y).logical_and(x >= z);
    const at::Tensor faces_y = faces_x.logical_not().logical_and(y >= z);
    return {at::where(faces_x, channel(position, 2), channel(position, 0)),
            at::where(faces_y, channel(position, 2), channel(position, 1))};
}

}  // namespace

at::Tensor depth_condition(const at::Tensor& depth, int downscale) {
    const at::NoGradGuard no_grad;
    return at::avg_pool2d(relative_disparity(depth, -1.0), downscale, downscale, 0,
                          /*ceil_mode=*/true);
}

at::Tensor depth_image(const at::Tensor& depth, std::int64_t height, std::int64_t width) {
    const at::NoGradGuard no_grad;
    return at::adaptive_avg_pool2d(relative_disparity(depth, 0.0), {height, width})
        .expand({-1, 3, -1, -1});
}

at::Tensor shape_cells(const SeenShape& shape, int downscale) {
    const at::NoGradGuard no_grad;
    const at::Tensor covered = (shape.depth > 0).to(at::kFloat).unsqueeze(1);
    const auto cells = [&](const at::Tensor& pixels) {
        return at::avg_pool2d(pixels, downscale, downscale, 0, /*ceil_mode=*/true);
    };
    const at::Tensor share = cells(covered).clamp_min(1e-6);
    const auto mean = [&](const at::Tensor& values) {
        return cells(values.permute({0, 3, 1, 2}) * covered) / share;
    };
    return at::cat(
        {depth_condition(shape.depth, downscale), mean(shape.position), mean(shape.normal)}, 1);
}

at::Tensor shape_condition(const at::Tensor& cells, int channels) {
    const at::NoGradGuard no_grad;
    if (channels == 0) return {};
    const at::Tensor depth = cells.slice(1, 0, 1);
    if (channels == 1) return depth;
    ITEM3D_CHECK(channels == surface_condition_channels,
                 "no shape condition has this number of channels");
    const at::Tensor covered = depth > -1;
    std::vector<at::Tensor> all{depth, cells.slice(1, 4)};
    const auto add_wave = [&](const at::Tensor& cycles) {
        all.push_back((2 * pi * cycles).sin() * covered);
        all.push_back((2 * pi * cycles).cos() * covered);
    };
    for (const float cycles : cycles_a_unit)
        add_wave(cells.slice(1, 1, 4) * cycles);
    const auto [u, v] = plane_coordinates(cells.slice(1, 1, 4), cells.slice(1, 4));
    for (const auto& [along_u, along_v] : plane_cycles)
        add_wave(u * along_u + v * along_v);
    return at::cat(all, 1);
}

bool takes_shape(const DiffusionModel& model) {
    const int channels = model.condition_channels();
    return model.controlnet_downscale() > 0 || channels == 1 ||
           channels == surface_condition_channels;
}

at::Tensor condition_of_shape(const DiffusionModel& model, const SeenShape& shape,
                              const at::Tensor& latents) {
    if (!takes_shape(model) || !shape.depth.defined()) return {};
    const std::int64_t height = latents.size(2), width = latents.size(3);
    if (model.controlnet_downscale() > 0) {
        const int pixels = model.controlnet_downscale();
        return depth_image(shape.depth, height * pixels, width * pixels).to(latents.device());
    }
    const auto downscale = static_cast<int>(shape.depth.size(1) / height);
    if (model.condition_channels() == 1)
        return depth_condition(shape.depth, downscale).to(latents.device());
    return shape_condition(shape_cells(shape, downscale), model.condition_channels())
        .to(latents.device());
}

}  // namespace item3d
