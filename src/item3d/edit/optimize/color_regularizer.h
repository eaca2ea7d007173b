// A regulariser against blotches, which guidance leaves behind where the target has no pattern.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <optional>

namespace item3d {

/// An edit towards a plain colour or metal is taken for a recolouring: what it adds to a material
/// is an affine function of the base colour that was there, the same all over the surface, so that
/// spots and stripes stay to be seen. What departs from the best such function is pulled back, the
/// less the further it is away (the weights of Geman and McClure), because a part that guidance
/// keeps apart, as a handle of another colour, is no blotch. Towards a metal, roughness is pulled
/// to that metal's own: images of a small prior tell little of it.
class ColorRegularizer {
  public:
    /// Does nothing unless plan.regularizes_color: where `evenness` is 0 or the target names
    /// detail.
    ColorRegularizer(const EditScene& scene, const EditPlan& plan, const EditState& state);

    /// Adds the gradient of this process's share of the points to the field's. A function of the
    /// field and the iteration alone.
    void backward(const ProcessGroup& processes, EditState& state) const;

  private:
    float weight_ = 0;
    at::Tensor positions_;  ///< [draws, P, 3] of the surface
    at::Tensor fitted_;     ///< [draws, P, 8] as NeuralTexture::encoded(), before the edit
    std::optional<float> metal_roughness_;  ///< of the metal that the surface becomes
    bool holds_metallic_ = false;
    at::Tensor channels_;  ///< [8] 1 for those of base colour, roughness and metallic that change
};

struct Departures {
    at::Tensor values;   ///< [P, C]
    at::Tensor weights;  ///< [P, 1] 0 to 1: what each point counted
};

/// `change` [P, C] without its best affine function of `color` [P, 3]. Points that depart by much
/// more than `scale` hardly count. For ColorRegularizer and its tests.
Departures departures(const at::Tensor& change, const at::Tensor& color, float scale);

}  // namespace item3d
