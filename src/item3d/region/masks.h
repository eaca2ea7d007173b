// A region as pictures in UV space.
#pragma once

#include "item3d/field/atlas/atlas.h"
#include "item3d/region/region.h"
#include "item3d/scene/image.h"

#include <map>

namespace item3d {

/// Of each texture set that has UVs of its own, by its first material: the weights of its texels,
/// one channel, as large as the texture that is baked. Around the triangles they go on as far as
/// the texture itself does.
std::map<int, Image> region_masks(const Region& region, const Model& model,
                                  const Geometry& geometry, const Atlas& atlas, int texture_size);

}  // namespace item3d
