// Identification of surface points that share a texel: they share a position in the neural texture,
// so that the optimised result can be baked.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>
#include <vector>

namespace item3d {

/// Maps points of texture sets with shared texels to the representative of their texel: the point
/// of the atlas's first triangle that shows it.
class SharedTexels {
  public:
    /// The identity.
    SharedTexels() = default;
    /// texture_size: as for make_atlas(). device: that of the surfaces passed later.
    SharedTexels(const Model& model, const Atlas& atlas, int texture_size, at::Device device);

    bool empty() const { return grids_.empty(); }

    /// Returns [P, 3] representatives of `positions` [P, 3] of `surface`, both in the space of the
    /// first instances.
    at::Tensor representatives(const Surface& surface, const at::Tensor& positions) const;

  private:
    /// The texels of one texture set.
    struct Grid {
        std::vector<int> materials;
        int width = 0, height = 0;
        UvWrap wrap;
        at::Tensor owner;  ///< [height * width] int64, a row of `places`; 0: unowned
    };

    void add(const Model& model, const Atlas& atlas, const TextureSet& set, int texture_size,
             const std::vector<std::array<Vec3, 3>>& corners, std::vector<float>& places);

    std::vector<Grid> grids_;
    at::Tensor places_;  ///< [rows, 16] float32, see shared_texels.cpp
};

}  // namespace item3d
