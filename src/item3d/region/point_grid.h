// A hash grid of points for neighbour queries.
#pragma once

#include "item3d/core/math.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace item3d {

class PointGrid {
  public:
    /// points: [K, 3] float32 on the CPU. reach: query radius.
    PointGrid(const at::Tensor& points, float reach);

    float reach() const { return reach_; }

    /// Calls visit(point index, position) for all points within reach, and for some beyond it.
    template <typename Visit>
    void for_each_near(Vec3 place, const Visit& visit) const {
        const glm::ivec3 home = cell_at(place);
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const auto found = cells_.find(key(home + glm::ivec3(x, y, z)));
                    if (found == cells_.end()) continue;
                    for (const std::int64_t i : found->second)
                        visit(i, points_[static_cast<std::size_t>(i)]);
                }
    }

  private:
    glm::ivec3 cell_at(Vec3 place) const { return glm::ivec3(glm::floor(place / reach_)); }
    /// Hash collisions of two cells only cause additional visits.
    static std::uint64_t key(glm::ivec3 cell);

    float reach_;
    std::vector<Vec3> points_;
    std::unordered_map<std::uint64_t, std::vector<std::int64_t>> cells_;
};

}  // namespace item3d
