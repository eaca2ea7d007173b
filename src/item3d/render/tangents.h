// Tangent frames for normal maps of models without tangents.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns the tangent space that glTF prescribes and baking tools use: MikkTSpace (M. S.
/// Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008; mikktspace.com), with its usual
/// threshold of 180 degrees. One tangent for each of primitive.indices: x, y, z the direction of
/// growing u, unit and orthogonal to the normal; w the handedness, so that cross(normal, tangent) *
/// w points towards falling v. Corners with degenerate UVs get any tangent perpendicular to their
/// normal, and w 1. The primitive must have UVs and normals.
std::vector<Vec4> corner_tangents(const Primitive& primitive);

/// Sets primitive.tangents from its corners. A vertex whose corners differ (a mirrored seam) is
/// split: the first copy keeps its index, the others are appended.
void add_tangents(Primitive& primitive);

}  // namespace item3d
