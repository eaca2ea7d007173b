#include "item3d/region/point_grid.h"

#include "item3d/core/random.h"

namespace item3d {

PointGrid::PointGrid(const at::Tensor& points, float reach) : reach_(reach) {
    const at::Tensor rows = points.contiguous();
    const float* p = rows.const_data_ptr<float>();
    for (std::int64_t i = 0; i < rows.size(0); ++i) {
        points_.emplace_back(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
        cells_[key(cell_at(points_.back()))].push_back(i);
    }
}

std::uint64_t PointGrid::key(glm::ivec3 cell) {
    const auto part = [](int value) { return std::uint64_t{static_cast<std::uint32_t>(value)}; };
    return mix_bits((part(cell.x) << 32) ^ mix_bits((part(cell.y) << 32) ^ part(cell.z)));
}

}  // namespace item3d
