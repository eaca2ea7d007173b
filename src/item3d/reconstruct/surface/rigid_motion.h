// Rigid motions of the object in front of a camera, equivalent to motions of the camera.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Rigid motion of the object in front of a fixed camera: x -> R (x - c) + c + t. Differentiable in
/// rotation and translation.
struct RigidMotion {
    at::Tensor rotation;     ///< R, [3, 3]
    at::Tensor translation;  ///< t, [3]
    at::Tensor centre;       ///< c, [3]

    at::Tensor moved(const at::Tensor& positions) const;
    /// Returns the geometry with positions and normals moved.
    Geometry moved(Geometry geometry) const;
    /// Undoes the motion of a surface that was drawn from moved(), in its positions, normals and
    /// view directions. Materials and light are defined for the unmoved object.
    void move_back(Surface& surface) const;
    /// Returns the moved camera. It sees the unmoved object as `camera` sees the moved object.
    Camera seen_from(const Camera& camera) const;
    RigidMotion detached() const;
};

/// Motion as six numbers.
struct SmallMotion {
    at::Tensor rotation;     ///< [3], axis times angle
    at::Tensor translation;  ///< [3], in units of the object's radius
};

/// Converts the six numbers, differentiably. centre: centre of the rotation, [3].
RigidMotion rigid_motion(const SmallMotion& motion, const at::Tensor& centre, float radius);

}  // namespace item3d
