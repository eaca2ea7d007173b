// A camera that is a little off, brought nearer by what its photograph shows.
#pragma once

#include "item3d/reconstruct/surface/rigid_motion.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// A picture of the object by a camera, with the places that it shows.
struct DrawnView {
    Camera camera;
    at::Tensor image;     ///< [1, H, W, 4] premultiplied linear RGB and coverage
    at::Tensor pixel;     ///< [P] covered pixels, index into H*W
    at::Tensor position;  ///< [P, 3] of the surface there, world space
};

/// The motion that brings the drawn picture to the photograph [1, H, W, 4]: one step of
/// Gauss-Newton on color (log-sRGB over grey) and coverage of the covered pixels, both blurred over
/// 3 x 3 pixels, with the mean of both pictures' slopes (Malis 2004, "Improving vision-based
/// control using efficient second-order minimization techniques") and weights that make squares
/// absolute values. What the picture hardly says is damped. No motion where too little is drawn.
SmallMotion pose_step(const DrawnView& drawn, const at::Tensor& photograph,
                      const at::Tensor& centre, float radius);

}  // namespace item3d
