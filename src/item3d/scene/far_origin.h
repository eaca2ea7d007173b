// The origin of models whose positions lie far from it.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <span>

namespace item3d {

/// Returns the offset to subtract from positions within this box before their conversion to
/// float32: zero, unless the box's centre is more than 64 of its longest sides away, where
/// float32's precision would show (maps in metres east and north). A multiple of a power of two, so
/// that the subtraction from a double is exact.
glm::dvec3 far_origin(const glm::dvec3& low, const glm::dvec3& high);

/// Returns float32's spacing at the farthest of these positions, relative to their box's longest
/// side, at most 1; 0 if they coincide, or are empty.
double float32_step(std::span<const glm::dvec3> positions);

/// Moves all positions so that Model::origin becomes `origin`. Zero restores the file's positions,
/// up to float32's precision. For models that must share one space, because they are compared or
/// seen by cameras.
void move_origin(Model& model, const glm::dvec3& origin);

}  // namespace item3d
