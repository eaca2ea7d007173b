#include "item3d/scene/bounding_sphere.h"

#include <algorithm>

namespace item3d {

BoundingSphere bounding_sphere(const Model& model) {
    const auto [low, high] = model.bounds();
    BoundingSphere sphere{0.5f * (low + high), 0.0f};
    for (const Primitive& primitive : model.primitives) {
        for (const Vec3& position : primitive.positions) {
            sphere.radius = std::max(sphere.radius, glm::length(position - sphere.center));
        }
    }
    return sphere;
}

}  // namespace item3d
