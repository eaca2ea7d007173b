#include "item3d/scene/model.h"

#include "item3d/scene/normals.h"

#include <limits>

namespace item3d {

std::size_t Model::triangle_count() const {
    std::size_t count = 0;
    for (const Primitive& primitive : primitives)
        count += primitive.indices.size() / 3;
    return count;
}

std::array<Vec3, 2> Model::bounds() const {
    Vec3 low(std::numeric_limits<float>::max());
    Vec3 high(std::numeric_limits<float>::lowest());
    for (const Primitive& primitive : primitives) {
        for (const Vec3& position : primitive.positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
    }
    return {low, high};
}

void compute_smooth_normals(Primitive& primitive) {
    primitive.normals = smooth_normals(primitive.positions, primitive.indices);
}

}  // namespace item3d
