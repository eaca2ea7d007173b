// Where the origin goes for models that lie far from it.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <span>

namespace item3d {

/// What to take off positions within this box before they become float32: zero, unless the box's
/// centre is more than 64 of its longest sides away, where float32 would show (maps' metres east
/// and north). A multiple of a power of two, so that taking it off a double is exact.
glm::dvec3 far_origin(const glm::dvec3& low, const glm::dvec3& high);

/// The step of float32 at the farthest of these positions, as a part of their box's longest side,
/// at most 1; 0 where they are one point, or none.
double float32_step(std::span<const glm::dvec3> positions);

/// Moves all positions so that Model::origin is this one; zero: as the file has them, as far as
/// float32 goes. For models that are compared, or seen by cameras, in one space.
void move_origin(Model& model, const glm::dvec3& origin);

}  // namespace item3d
