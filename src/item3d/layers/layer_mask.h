// The region of a layer, from its masks.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

#include <map>

namespace item3d {

/// Weights of a region from the layer's masks in UV space, for models with the edit's UV map. A
/// mask smaller than the baked texture is interpolated; other masks are looked up by texel.
class LayerMask {
  public:
    /// texture_size: size of the baked textures, as for atlas_size().
    LayerMask(const EditLayer& layer, const Model& model, int texture_size);

    /// True if each of the layer's materials has a mask.
    bool is_complete() const { return is_complete_; }
    /// Returns the weights of the P points of `surface`, [P, 1] float32 in [0, 1] on its device.
    /// Points on a material without a mask have the weight 0.
    at::Tensor weight(const Surface& surface) const;

  private:
    struct Mask {
        at::Tensor weights;  ///< [height, width] float32
        UvWrap wrap;
        bool is_enlarged = false;
    };
    static float weight_at(const Mask& mask, Vec2 uv);

    std::map<std::int64_t, Mask> of_material_;
    bool is_complete_ = true;
};

}  // namespace item3d
