#include "item3d/reconstruct/surface/appearance.h"

#include <algorithm>
#include <cmath>

namespace item3d {

float pixel_size(std::array<Vec3, 2> bounds, const TargetView& view) {
    const float distance = glm::distance(view.camera.position(), 0.5f * (bounds[0] + bounds[1]));
    return 2 * std::tan(0.5f * view.camera.field_of_view_x) * distance /
           static_cast<float>(view.width());
}

MaterialRanges reconstruction_ranges() {
    MaterialRanges ranges;
    ranges.base_color = {0.03f, 1.0f};
    ranges.roughness = {0.08f, 1.0f};
    ranges.normal_slope = 1.0f;
    return ranges;
}

Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           std::uint64_t seed) {
    NeuralTextureOptions options;
    options.seed = seed;
    options.ranges = reconstruction_ranges();
    const Vec3 size = bounds[1] - bounds[0];
    const float extent = std::max({size.x, size.y, size.z});
    options.bounds = {bounds[0] - 0.02f * extent, bounds[1] + 0.02f * extent};
    options.finest_resolution =
        std::clamp(static_cast<int>(extent / pixel_size(bounds, views.front())), 64, 1024);
    NeuralTexture field(options);
    {
        // Most things are no metal, and a grey metal explains a picture nearly as well as paint.
        const at::NoGradGuard no_gradient;
        field->output_bias(OrmChannel::metallic).fill_(-3.0f);
    }
    return {std::move(field), TrainableLight()};
}

}  // namespace item3d
