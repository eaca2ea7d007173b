// Surface points that share a texel share a place in the neural texture: what is optimised is then
// what can be baked.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>
#include <vector>

namespace item3d {

/// Moves points of the texture sets that share texels to the place that represents their texel: the
/// point of the first triangle of the atlas that shows it.
class SharedTexels {
  public:
    /// Moves nothing.
    SharedTexels() = default;
    /// texture_size: as for make_atlas. device: of the surfaces to come.
    SharedTexels(const Model& model, const Atlas& atlas, int texture_size, at::Device device);

    bool empty() const { return grids_.empty(); }

    /// [P, 3]: `positions` [P, 3] of `surface` in the space of the first instances, moved.
    at::Tensor representatives(const Surface& surface, const at::Tensor& positions) const;

  private:
    /// The texels of one texture set.
    struct Grid {
        std::vector<int> materials;
        int width = 0, height = 0;
        UvWrap wrap;
        at::Tensor owner;  ///< [height * width] int64, a row of `places`; 0: nobody's
    };

    void add(const Model& model, const Atlas& atlas, const TextureSet& set, int texture_size,
             const std::vector<std::array<Vec3, 3>>& corners, std::vector<float>& places);

    std::vector<Grid> grids_;
    at::Tensor places_;  ///< [rows, 16] float32, see shared_texels.cpp
};

}  // namespace item3d
