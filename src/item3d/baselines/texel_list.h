// The texels of the edited materials as one list of surface points, and values of theirs looked up
// where pictures see the surface.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <map>
#include <vector>

namespace item3d {

/// The model's triangles with the UVs that its atlas bakes into; triangles keep their order.
Geometry atlas_geometry(const Model& model, const Atlas& atlas, at::Device device);

/// T texels: those that a triangle covers, set after set, row by row.
class TexelList {
  public:
    /// geometry: of the model, whose triangles the atlas names. texture_size: as for atlas_size();
    /// longest edges are at most max_edge.
    TexelList(const Model& model, const Geometry& geometry, const Atlas& atlas, int texture_size,
              int max_edge);

    std::int64_t count() const { return surface_.count(); }
    /// The middle of each texel on the surface, with the UVs of `geometry`.
    const Surface& surface() const { return surface_; }
    /// The same with the UVs of another geometry of the same triangles.
    Surface on(const Geometry& geometry) const;

    /// values [T, C] at points whose uv is the atlas's: [P, C], bilinear, or the nearest texel's.
    /// Beside the border of an island its own texels continue. Points of other materials get 0.
    at::Tensor lookup(const at::Tensor& values, const Surface& points, bool nearest = false) const;
    /// [P] bool: whether the point's material is among the edited ones.
    at::Tensor has(const Surface& points) const;

    /// values [T, C] spread in the texture, a texel's own where known [T] bool says so: pulled up a
    /// pyramid of means of two by two known texels, and pushed down bilinearly into what has none
    /// (Gortler et al. 1996, "The Lumigraph", section 3.4.2). Sets without any known texel get 0.
    at::Tensor spread(const at::Tensor& values, const at::Tensor& known) const;

    /// values [T, 3] as pictures, by the first material of each texture set.
    std::map<int, Image> images(const at::Tensor& values) const;

  private:
    /// The texels of one texture set: cells [first, first + width * height) of all.
    struct Grid {
        std::vector<int> materials;
        int width = 0, height = 0;
        UvWrap wrap;
        std::int64_t first = 0;
    };
    struct Found;
    void add(const Model& model, const Atlas& atlas, const TextureSet& set, int texture_size,
             int max_edge, Found& found);

    std::vector<Grid> grids_;
    at::Tensor texel_of_;  ///< [cells] the cell's own texel or a neighbour's; -1: none
    at::Tensor cell_of_;   ///< [T] the cell that is a texel's own
    at::Tensor grid_of_;   ///< [materials] int64, -1: not edited
    at::Tensor triangle_, barycentrics_;  ///< [T], [T, 2]
    Surface surface_;
};

}  // namespace item3d
