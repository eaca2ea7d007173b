// A regulariser against the blotches that guidance leaves where the target has no pattern.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <optional>

namespace item3d {

/// Regularises an edit whose target is a plain colour or metal. Such an edit should change a
/// material by one affine function of the previous base colour over the whole surface, so that
/// spots and stripes remain visible. The regulariser finds the best affine function and reduces the
/// change's residuals from it. Larger residuals get smaller weights (Geman-McClure), because a
/// large residual is usually a distinct part, such as a handle of another colour, and not a blotch.
/// If the target is a metal, it also pulls roughness to the metal's own value, because the images
/// of a small prior hardly determine roughness.
class ColorRegularizer {
  public:
    /// Prepares the points. The object does nothing unless plan.regularizes_color, which is false
    /// if `evenness` is 0 or the target names detail.
    ColorRegularizer(const EditScene& scene, const EditPlan& plan, const EditState& state);

    /// Adds the gradient of this process's share of the points to the gradient of the neural
    /// texture. Deterministic in the neural texture and the iteration.
    void backward(const ProcessGroup& processes, EditState& state) const;

  private:
    float weight_ = 0;
    at::Tensor positions_;  ///< [draws, P, 3] surface points
    at::Tensor fitted_;     ///< [draws, P, 8] NeuralTexture::encoded() before the edit
    std::optional<float> metal_roughness_;  ///< roughness of the target metal, if there is one
    bool holds_metallic_ = false;
    at::Tensor channels_;  ///< [8] 1 for the edited channels of base colour, roughness and metallic
};

struct Departures {
    at::Tensor values;   ///< [P, C]
    at::Tensor weights;  ///< [P, 1] robust weight of each point, 0 to 1
};

/// Returns the residuals of `change` [P, C] from its best affine function of `color` [P, 3]. Points
/// whose residual is much larger than `scale` hardly count in the fit. For ColorRegularizer and its
/// tests.
Departures departures(const at::Tensor& change, const at::Tensor& color, float scale);

}  // namespace item3d
