// Rigid motions of the object in front of a camera, which a moved camera would show alike.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// A rigid motion of the object in front of a camera that stands still: x -> R (x - c) + c + t.
/// Differentiable in both.
struct RigidMotion {
    at::Tensor rotation;     ///< R, [3, 3]
    at::Tensor translation;  ///< t, [3]
    at::Tensor centre;       ///< c, [3]

    at::Tensor moved(const at::Tensor& positions) const;
    /// Positions and normals moved.
    Geometry moved(Geometry geometry) const;
    /// Positions, normals and view directions of what was drawn of moved(), back where they were:
    /// materials and light do not move.
    void move_back(Surface& surface) const;
    Camera seen_from(const Camera& camera) const;  ///< the same picture, by a moved camera
    RigidMotion detached() const;
};

/// A motion as six numbers.
struct SmallMotion {
    at::Tensor rotation;     ///< [3], axis times angle
    at::Tensor translation;  ///< [3], of the radius
};

/// Differentiable in the six numbers. centre: [3], what the rotation is about.
RigidMotion rigid_motion(const SmallMotion& motion, const at::Tensor& centre, float radius);

}  // namespace item3d
