#include "item3d/reconstruct/surface/appearance.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr int matt_light_height = 64, smooth_light_height = 128;

}  // namespace

float pixel_size(std::array<Vec3, 2> bounds, const TargetView& view) {
    const float distance = glm::distance(view.camera.position(), 0.5f * (bounds[0] + bounds[1]));
    return 2 * std::tan(0.5f * view.camera.field_of_view_x) * distance /
           static_cast<float>(view.width());
}

MaterialRanges reconstruction_ranges() {
    MaterialRanges ranges;
    ranges.base_color = {0.01f, 1.0f};
    ranges.roughness = {0.04f, 1.0f};
    ranges.normal_slope = 1.0f;
    return ranges;
}

Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           AppearanceStart start, std::uint64_t seed) {
    NeuralTextureOptions options;
    options.seed = seed;
    options.ranges = reconstruction_ranges();
    const Vec3 size = bounds[1] - bounds[0];
    const float extent = std::max({size.x, size.y, size.z});
    options.bounds = {bounds[0] - 0.02f * extent, bounds[1] + 0.02f * extent};
    options.finest_resolution =
        std::clamp(static_cast<int>(extent / pixel_size(bounds, views.front())), 64, 1024);
    NeuralTexture field(options);
    const bool is_smooth = start == AppearanceStart::smooth;
    {
        const at::NoGradGuard no_gradient;
        field->output_bias(OrmChannel::metallic).fill_(is_smooth ? 0.0f : -3.0f);
        if (is_smooth) field->output_bias(OrmChannel::roughness).fill_(-2.0f);
    }
    return {std::move(field), TrainableLight(is_smooth ? smooth_light_height : matt_light_height)};
}

}  // namespace item3d
