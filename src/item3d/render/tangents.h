// Tangent frames for normal maps of models without tangents.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns the tangent space that glTF prescribes and baking tools use: MikkTSpace (M. S.
/// Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008; mikktspace.com), with its usual
/// threshold of 180 degrees. The result has one tangent for each of primitive.indices. Its x, y and
/// z are the direction of growing u, as a unit vector orthogonal to the normal. Its w is the
/// handedness: cross(normal, tangent) * w points towards falling v. Corners with degenerate UVs get
/// any tangent perpendicular to their normal, and w 1. The primitive must have UVs and normals.
std::vector<Vec4> corner_tangents(const Primitive& primitive);

/// Sets primitive.tangents from its corners. A vertex whose corners have different tangents, as at
/// a mirrored seam, is split. The first copy keeps the index, and further copies are appended.
void add_tangents(Primitive& primitive);

}  // namespace item3d
