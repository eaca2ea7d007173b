// One Gauss-Newton step of a camera pose towards its photograph.
#pragma once

#include "item3d/reconstruct/surface/rigid_motion.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Render of the object by a camera, with its surface points.
struct DrawnView {
    Camera camera;
    at::Tensor image;     ///< [1, H, W, 4] premultiplied linear RGB and coverage
    at::Tensor pixel;     ///< [P] covered pixels, index into H*W
    at::Tensor position;  ///< [P, 3] surface point, world space
};

/// Returns the motion that aligns the render with the photograph [1, H, W, 4]: one step of
/// Gauss-Newton on color (log-sRGB over grey) and coverage of the covered pixels, both blurred over
/// 3 x 3 pixels, with the mean of both images' gradients (Malis 2004, "Improving vision-based
/// control using efficient second-order minimization techniques") and weights that turn squares
/// into absolute values. Poorly determined directions are damped. No motion if too little is drawn.
SmallMotion pose_step(const DrawnView& drawn, const at::Tensor& photograph,
                      const at::Tensor& centre, float radius);

}  // namespace item3d
