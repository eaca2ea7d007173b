// Conversion of a signed distance to triangles: naive surface nets (Gibson 1998, "Constrained
// Elastic Surface Nets", without relaxation).
#pragma once

#include "item3d/prior/data/shapes/signed_distance.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Surface of the distance's zero set inside [-extent, extent]^3 on a grid of resolution^3 cells.
/// Normals are the distance's gradient. The result is moved and scaled so that its bounding box is
/// centred and its farthest vertex lies on the unit sphere; `scale` and `center` map back: p_shape
/// = p * scale + center. A block of cells is skipped if the distance at its middle proves it empty.
/// Distances may be up to 1.5 times too large.
struct Polygonized {
    Primitive primitive;
    float scale = 1.0f;
    Vec3 center{0.0f};
};
Polygonized polygonize(const SignedDistance& distance, int resolution, float extent = 1.35f);

}  // namespace item3d
