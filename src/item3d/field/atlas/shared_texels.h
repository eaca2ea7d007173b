// Identification of the surface points that share a texel. Such points get the same position in the
// neural texture, so that the optimised result can be baked.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>
#include <vector>

namespace item3d {

/// Maps points to the representative of their texel, in texture sets with shared texels. The
/// representative is the point on the atlas's first triangle that shows the texel.
class SharedTexels {
  public:
    /// Makes the identity, which maps each point to itself.
    SharedTexels() = default;
    /// texture_size: as for make_atlas(); device: that of the surfaces passed later.
    SharedTexels(const Model& model, const Atlas& atlas, int texture_size, at::Device device);

    bool empty() const { return grids_.empty(); }

    /// Returns the representatives [P, 3] of the points of `surface`. positions: [P, 3] of these
    /// points. Positions and representatives are in the space of the first instances.
    at::Tensor representatives(const Surface& surface, const at::Tensor& positions) const;

  private:
    /// The texels of one texture set.
    struct Grid {
        std::vector<int> materials;
        int width = 0, height = 0;
        UvWrap wrap;
        at::Tensor owner;  ///< [height * width] int64, row in places_; 0: no owner
    };

    void add(const Model& model, const Atlas& atlas, const TextureSet& set, int texture_size,
             const std::vector<std::array<Vec3, 3>>& corners, std::vector<float>& places);

    std::vector<Grid> grids_;
    at::Tensor places_;  ///< [rows, 16] float32; shared_texels.cpp lists the columns
};

}  // namespace item3d
