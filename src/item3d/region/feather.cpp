#include "item3d/region/feather.h"

#include "item3d/core/parallel.h"
#include "item3d/core/random.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Neighbouring cells may share a number by chance; then more points are compared.
std::uint64_t cell_of(glm::ivec3 place) {
    const auto part = [](int value) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value));
    };
    return mix_bits(part(place.x) << 32 ^ mix_bits(part(place.y) << 32 ^ part(place.z)));
}

}  // namespace

Feather::Feather(const at::Tensor& outside, float width) : width_(width) {
    const at::Tensor points = outside.contiguous();
    const float* p = points.const_data_ptr<float>();
    for (std::int64_t i = 0; i < points.size(0); ++i) {
        const Vec3 point(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
        cells_[cell_of(glm::ivec3(glm::floor(point / width)))].push_back(point);
    }
}

float Feather::nearest(Vec3 position) const {
    const glm::ivec3 home(glm::floor(position / width_));
    float least = width_ * width_;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const auto found = cells_.find(cell_of(home + glm::ivec3(x, y, z)));
                if (found == cells_.end()) continue;
                for (const Vec3& point : found->second) {
                    const Vec3 apart = point - position;
                    least = std::min(least, glm::dot(apart, apart));
                }
            }
    return std::sqrt(least);
}

at::Tensor Feather::weight(const at::Tensor& positions_, const at::Tensor& inside_) const {
    const at::Tensor positions = positions_.contiguous(), inside = inside_.contiguous();
    at::Tensor weights = at::zeros({positions.size(0)}, at::kFloat);
    const float* p = positions.const_data_ptr<float>();
    const float* in = inside.const_data_ptr<float>();
    float* out = weights.data_ptr<float>();
    parallel_for(
        "feather", positions.size(0),
        [&](std::int64_t i) {
            if (in[i] == 0) return;
            const float t = nearest(Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2])) / width_;
            out[i] = t * t * (3 - 2 * t);
        },
        256);
    return weights;
}

}  // namespace item3d
