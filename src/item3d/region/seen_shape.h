// The visible shape in a render, as input of a prior.
#pragma once

#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/rasterize.h"
#include "item3d/scene/bounding_sphere.h"

namespace item3d {

/// Returns the visible shape, without an autograd graph. sphere: bounding sphere of the whole
/// model.
SeenShape seen_shape(const Raster& raster, const Surface& surface, const BoundingSphere& sphere);

}  // namespace item3d
