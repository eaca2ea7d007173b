#include "item3d/region/feather.h"

#include "item3d/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {
namespace {

constexpr float beside = 3;  ///< maximum distance of adjacent points, in spacings

Vec3 row_of(const float* rows, std::int64_t i) {
    return {rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]};
}

/// Returns the points of `outside` that are adjacent to `inside`. The other points are farther from
/// the region, so they do not affect distances, and a wide feather would have to visit them for
/// each point.
at::Tensor border_of(const at::Tensor& outside_, const at::Tensor& inside, float spacing) {
    const at::Tensor outside = outside_.contiguous();
    const PointGrid grid(inside, beside * spacing);
    std::vector<std::int64_t> chosen;
    for (std::int64_t i = 0; i < outside.size(0); ++i) {
        const Vec3 place = row_of(outside.const_data_ptr<float>(), i);
        bool is_beside = false;
        grid.for_each_near(place, [&](std::int64_t, Vec3 point) {
            const Vec3 apart = point - place;
            is_beside = is_beside || glm::dot(apart, apart) < grid.reach() * grid.reach();
        });
        if (is_beside) chosen.push_back(i);
    }
    return outside.index_select(0, at::tensor(chosen, at::kLong));
}

}  // namespace

Feather::Feather(const at::Tensor& outside, const at::Tensor& inside, float spacing, float width)
    : border_(border_of(outside, inside, spacing), width) {}

at::Tensor Feather::weight(const at::Tensor& positions_, const at::Tensor& inside_) const {
    const at::Tensor positions = positions_.contiguous(), inside = inside_.contiguous();
    at::Tensor weights = at::zeros({positions.size(0)}, at::kFloat);
    const float* p = positions.const_data_ptr<float>();
    const float* in = inside.const_data_ptr<float>();
    float* out = weights.data_ptr<float>();
    const float width = border_.reach();
    parallel_for(
        "feather", positions.size(0),
        [&](std::int64_t i) {
            if (in[i] == 0) return;
            const Vec3 place = row_of(p, i);
            float nearest = width * width;
            border_.for_each_near(place, [&](std::int64_t, Vec3 point) {
                const Vec3 apart = point - place;
                nearest = std::min(nearest, glm::dot(apart, apart));
            });
            const float t = std::sqrt(nearest) / width;
            out[i] = t * t * (3 - 2 * t);
        },
        256);
    return weights;
}

}  // namespace item3d
