// The bounding sphere of a model.
#pragma once

#include "item3d/scene/model.h"

namespace item3d {

/// Centre and radius of a sphere around the model, in world units.
struct BoundingSphere {
    Vec3 center{0.0f};
    float radius = 1.0f;
};
BoundingSphere bounding_sphere(const Model& model);

}  // namespace item3d
