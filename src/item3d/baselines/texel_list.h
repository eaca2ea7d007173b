// The texels of the edited materials as one list of surface points, and lookups of values stored
// for them.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <map>
#include <vector>

namespace item3d {

/// Returns the model's triangles with the UVs of its atlas; triangles keep their order.
Geometry atlas_geometry(const Model& model, const Atlas& atlas, at::Device device);

/// The T texels that the surface covers, ordered by texture set and within a set by row.
class TexelList {
  public:
    /// geometry: the model's, with the atlas's triangles; texture_size: as for atlas_size();
    /// max_edge: limit of the textures' longest edges.
    TexelList(const Model& model, const Geometry& geometry, const Atlas& atlas, int texture_size,
              int max_edge);

    std::int64_t count() const { return surface_.count(); }
    /// Returns the centre of each texel on the surface, with the UVs of `geometry`.
    const Surface& surface() const { return surface_; }
    /// Returns surface() with the UVs of another geometry of the same triangles.
    Surface on(const Geometry& geometry) const;

    /// Returns the values [T, C] at P points that have the atlas's UVs, as [P, C]. The lookup is
    /// bilinear, or takes the nearest texel. At the border of an island, the island's own texels
    /// are extrapolated. Points of materials that are not edited get 0.
    at::Tensor lookup(const at::Tensor& values, const Surface& points, bool nearest = false) const;
    /// Returns [P] bool: true for points of edited materials.
    at::Tensor has(const Surface& points) const;

    /// Fills the unknown texels of values [T, C] and keeps the known ones. The method is pull-push
    /// (Gortler et al. 1996, "The Lumigraph", section 3.4.2): a pyramid has the means of two by two
    /// known texels, which are interpolated bilinearly into the unknown ones. Texture sets without
    /// any known texel get 0. known: [T] bool.
    at::Tensor spread(const at::Tensor& values, const at::Tensor& known) const;

    /// Returns values [T, 3] as images, keyed by the first material of each texture set.
    std::map<int, Image> images(const at::Tensor& values) const;

  private:
    /// The texels of one texture set. They are the cells [first, first + width * height) of all
    /// cells.
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
    at::Tensor texel_of_;  ///< [cells] texel of the cell, else of a near one; -1: none
    at::Tensor cell_of_;   ///< [T] cell of each texel
    at::Tensor grid_of_;   ///< [materials] int64, -1: not edited
    at::Tensor triangle_, barycentrics_;  ///< [T], [T, 2]
    Surface surface_;
};

}  // namespace item3d
