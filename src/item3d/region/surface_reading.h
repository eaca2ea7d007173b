// What a network says of pictures of a model, gathered on its surface.
#pragma once

#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/region/selector.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

#include <functional>
#include <vector>

namespace item3d {

/// One of the pictures from all around.
struct ModelView {
    at::Tensor picture;  ///< [1, 3, S, S] sRGB in [0, 1], white behind the model
    SeenShape shape;     ///< [1, D, D, ...], D a multiple of S
};

/// Answers to Q questions about a picture: [Q, h, w] of any h and w; pixel (0, 0) covers the same
/// corner as the picture's.
using ViewReader = std::function<at::Tensor(const ModelView& view)>;

/// What was answered about points of the surface, which are spread evenly over it.
struct SurfaceReading {
    at::Tensor triangle;  ///< [K] int64
    at::Tensor position;  ///< [K, 3]
    at::Tensor seen;      ///< [K] bool: whether a view sees the point
    at::Tensor values;    ///< [Q, K]: means over views; 0 where none sees it
    float spacing = 0;    ///< within which a point's neighbours are found, in the model's units
};

/// Number of views: rings of cameras at three elevations.
int reading_views();

/// Asks `reader` about pictures of `pixels` a side from all around. A point takes the answers of
/// the views that see it, each by how squarely.
SurfaceReading read_surface(const RegionScene& scene, int pixels, const ViewReader& reader);

}  // namespace item3d
