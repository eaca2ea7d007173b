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
    at::Tensor pixel;     ///< [P] covered pixels: row * W + column
    at::Tensor position;  ///< [P, 3] surface point in world space
};

/// Returns one Gauss-Newton step of the motion that aligns the render with the photograph [1, H, W,
/// 4]. It reduces the differences in colour (log-sRGB over grey) and coverage at the covered
/// pixels. Both images are first blurred over 3 x 3 pixels. The step uses the mean of both images'
/// gradients (Malis 2004, "Improving vision-based control using efficient second-order minimization
/// techniques"). Weights give the squared differences the effect of absolute differences. Poorly
/// determined directions are damped. The motion is 0 if the render covers too few pixels.
SmallMotion pose_step(const DrawnView& drawn, const at::Tensor& photograph,
                      const at::Tensor& centre, float radius);

}  // namespace item3d
