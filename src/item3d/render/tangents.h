// Tangent frames for normal maps of models that bring none.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// The tangent space that glTF asks for and normal maps are baked in: MikkTSpace (M. S. Mikkelsen,
/// "Simulation of Wrinkled Surfaces Revisited", 2008; mikktspace.com), with its usual threshold of
/// 180 degrees. One tangent for each of primitive.indices: x, y, z the direction of growing u, unit
/// and orthogonal to the normal; w the handedness, so that cross(normal, tangent) * w points where
/// v falls. Corners without a direction (degenerate UVs) get one across their normal, w 1.
/// The primitive must have UVs and normals.
std::vector<Vec4> corner_tangents(const Primitive& primitive);

/// Fills primitive.tangents with those of its corners. A vertex whose corners differ (a mirrored
/// seam) becomes several: the first keeps its index, the others are added at the end.
void add_tangents(Primitive& primitive);

}  // namespace item3d
