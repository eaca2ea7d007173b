// A region as images in UV space.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/region/region.h"
#include "item3d/scene/image.h"

#include <map>

namespace item3d {

/// Returns the weights of texels for each texture set with its own UVs, keyed by its first
/// material: an image of one channel, in the size of the baked texture. Weights extend around the
/// triangles as far as the texture's padding.
std::map<int, Image> region_masks(const Region& region, const Model& model,
                                  const Geometry& geometry, const Atlas& atlas, int texture_size);

}  // namespace item3d
