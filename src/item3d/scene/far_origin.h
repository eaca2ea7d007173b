// A new origin for models whose positions are far from the file's origin.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <span>

namespace item3d {

/// Returns the offset to subtract from positions in the box from `low` to `high` before they are
/// converted to float32. The offset is zero unless the distance between the box's centre and the
/// origin is more than 64 times the box's longest side. Beyond that distance the rounding to
/// float32 would be visible, as in maps in metres east and north. The offset is a multiple of a
/// power of two, so that its subtraction from a double is exact.
glm::dvec3 far_origin(const glm::dvec3& low, const glm::dvec3& high);

/// Returns the spacing of float32 numbers at the position farthest from the origin, divided by the
/// longest side of the positions' bounding box; at most 1. Returns 0 if all positions coincide, or
/// there are none.
double float32_step(std::span<const glm::dvec3> positions);

/// Moves all positions so that Model::origin becomes `origin`. An `origin` of zero restores the
/// file's positions, up to float32's precision. Use it to give models one coordinate system, if
/// they are compared or viewed by the same cameras.
void move_origin(Model& model, const glm::dvec3& origin);

}  // namespace item3d
