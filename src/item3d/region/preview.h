// A region made visible on its model.
#pragma once

#include "item3d/region/region.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"

#include <vector>

namespace item3d {

/// One picture a camera, sRGB RGBA: what is in the region in orange, the rest in dim grey.
std::vector<Image> region_pictures(const Region& region, const Geometry& geometry,
                                   const TexturedMaterials& textured, const EnvironmentLight& light,
                                   const std::vector<Camera>& cameras, int pixels);

}  // namespace item3d
