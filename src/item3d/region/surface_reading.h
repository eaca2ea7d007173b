// A network's reading of renders of a model, gathered on its surface.
#pragma once

#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/region/selector.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

#include <functional>
#include <vector>

namespace item3d {

/// One of the renders from all sides.
struct ModelView {
    at::Tensor image;  ///< [1, 3, S, S] sRGB in [0, 1]; the background is white
    SeenShape shape;   ///< [1, D, D, ...], where D is a multiple of S
};

/// Returns the values of Q quantities in a render, [Q, h, w]. Any h and w are possible; the values
/// cover the whole image.
using ViewReader = std::function<at::Tensor(const ModelView& view)>;

/// Values at points that are spread evenly over the surface.
struct SurfaceReading {
    at::Tensor triangle;  ///< [K] int64
    at::Tensor position;  ///< [K, 3]
    at::Tensor seen;      ///< [K] bool: visible in a view
    at::Tensor values;    ///< [Q, K]: means over views; 0 for invisible points
    float spacing = 0;    ///< radius within which points are neighbours, in the model's units
};

/// Returns the number of views. Their cameras form rings at three elevations.
int reading_views();

/// Reads renders of `pixels` x `pixels` from all sides. A point's values are the mean over the
/// views that see it, weighted by the cosine of the viewing angle.
SurfaceReading read_surface(const RegionScene& scene, int pixels, const ViewReader& reader);

}  // namespace item3d
