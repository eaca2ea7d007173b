#include "item3d/baselines/texel_view.h"

#include <cmath>

namespace item3d {
namespace {

/// Smallest cosine in the estimate of a pixel's slope.
constexpr double flattest_slope = 0.1;

}  // namespace

TexelView see_texels(const Surface& texels, const Camera& camera, const at::Tensor& depth,
                     float tolerance) {
    const at::NoGradGuard no_grad;
    const auto options = texels.position.options();
    const Mat4 view = camera.world_to_camera();
    const auto row = [&](int r) {
        const at::Tensor axis = at::tensor({view[0][r], view[1][r], view[2][r]}, options);
        return texels.position.mv(axis) + view[3][r];
    };
    const at::Tensor ahead = -row(2);
    const float spread = std::tan(camera.field_of_view_x / 2);
    const at::Tensor reach = ahead.clamp_min(1e-6) * spread;
    TexelView seen;
    seen.place = at::stack({0.5 + 0.5 * row(0) / reach, 0.5 - 0.5 * row(1) / reach}, 1);

    const Vec3 eye = camera.position();
    const at::Tensor way = at::tensor({eye.x, eye.y, eye.z}, options) - texels.position;
    const at::Tensor cosine =
        (texels.normal * way).sum(1) / way.square().sum(1).sqrt().clamp_min(1e-12);

    const std::int64_t size = depth.size(0);
    const at::Tensor cell = (seen.place * size).floor().to(at::kLong);
    const at::Tensor x = cell.select(1, 0), y = cell.select(1, 1);
    const at::Tensor inside = (ahead > 0) & (x >= 0) & (x < size) & (y >= 0) & (y < size);
    const at::Tensor nearest =
        depth.flatten().index_select(0, (y * size + x) * inside.to(at::kLong));
    const at::Tensor facing = cosine.clamp(flattest_slope, 1);
    const at::Tensor slope =
        2 * reach / static_cast<double>(size) * (1 - facing.square()).sqrt() / facing;
    const at::Tensor is_seen = inside & (nearest > 0) & (ahead < nearest + tolerance + slope);
    seen.cosine = cosine.clamp_min(0) * is_seen;
    return seen;
}

at::Tensor sample_image(const at::Tensor& image, const at::Tensor& places) {
    const std::int64_t height = image.size(1), width = image.size(2);
    const at::Tensor x = (places.select(1, 0) * width - 0.5).clamp(0, width - 1);
    const at::Tensor y = (places.select(1, 1) * height - 0.5).clamp(0, height - 1);
    const at::Tensor x0 = x.floor().clamp_max(std::max<std::int64_t>(0, width - 2));
    const at::Tensor y0 = y.floor().clamp_max(std::max<std::int64_t>(0, height - 2));
    const at::Tensor flat = image.flatten(1).t();
    at::Tensor sum = at::zeros({places.size(0), image.size(0)}, image.options());
    for (int corner = 0; corner < 4; ++corner) {
        const int dx = corner % 2, dy = corner / 2;
        const at::Tensor column = (x0 + dx).clamp_max(width - 1).to(at::kLong);
        const at::Tensor line = (y0 + dy).clamp_max(height - 1).to(at::kLong);
        const at::Tensor weight =
            (1 - (x - x0 - dx).abs()) * (1 - (y - y0 - dy).abs()).clamp_min(0);
        sum = sum + weight.clamp_min(0).unsqueeze(1) * flat.index_select(0, line * width + column);
    }
    return sum;
}

ImageSample sample_pixels(const at::Tensor& image, const at::Tensor& counts,
                          const at::Tensor& places) {
    const at::Tensor sum = sample_image(at::cat({image * counts, counts}), places);
    const at::Tensor share = sum.select(1, image.size(0));
    return {sum.slice(1, 0, image.size(0)) / share.clamp_min(1e-6).unsqueeze(1), share};
}

}  // namespace item3d
