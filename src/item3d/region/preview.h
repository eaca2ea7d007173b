// Images of a region on its model.
#pragma once

#include "item3d/region/region.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"

#include <vector>

namespace item3d {

/// Returns one image for each camera, sRGB RGBA: the region in orange, the rest of the model in dim
/// grey.
std::vector<Image> region_images(const Region& region, const Geometry& geometry,
                                 const TexturedMaterials& textured, const EnvironmentLight& light,
                                 const std::vector<Camera>& cameras, int pixels);

}  // namespace item3d
