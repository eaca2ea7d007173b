#include "item3d/scene/far_origin.h"

#include <algorithm>
#include <cmath>

namespace item3d {

glm::dvec3 far_origin(const glm::dvec3& low, const glm::dvec3& high) {
    constexpr double max_sides = 64.0;
    const glm::dvec3 sides = high - low;
    const glm::dvec3 centre = 0.5 * (low + high);
    const double side = std::max({sides.x, sides.y, sides.z});
    const double distance = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)});
    if (!(side > 0.0) || !std::isfinite(distance) || distance <= max_sides * side) {
        return glm::dvec3(0.0);
    }
    const double step = std::exp2(std::ceil(std::log2(side)));
    return glm::round(centre / step) * step;
}

double float32_step(std::span<const glm::dvec3> positions) {
    if (positions.empty()) return 0.0;
    glm::dvec3 low = positions[0], high = positions[0];
    for (const glm::dvec3& position : positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    const glm::dvec3 sides = high - low;
    const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
    const double step = std::max({far.x, far.y, far.z}) * 0x1p-23;
    const double side = std::max({sides.x, sides.y, sides.z});
    return side > 0.0 ? std::min(1.0, step / side) : 0.0;
}

void move_origin(Model& model, const glm::dvec3& origin) {
    if (model.origin == origin) return;
    const glm::dvec3 shift = model.origin - origin;
    for (Primitive& primitive : model.primitives) {
        for (Vec3& position : primitive.positions)
            position = Vec3(glm::dvec3(position) + shift);
    }
    model.origin = origin;
}

}  // namespace item3d
