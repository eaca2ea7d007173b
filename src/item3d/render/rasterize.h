// Rasterization: the visible triangle of each pixel. The interface follows nvdiffrast (Laine et al.
// 2020, "Modular Primitives for High-Performance Differentiable Rendering").
#pragma once

#include "item3d/render/geometry.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Visible triangles at the pixel centres of N views. Row 0 is the top row.
struct Raster {
    at::Tensor barycentrics;    ///< [N, H, W, 2] float32 weights of the triangle's vertices 0 and 1
    at::Tensor depth;           ///< [N, H, W] float32 distance along the view axis (z-depth), or 0
    at::Tensor triangle;        ///< [N, H, W] int32, index of the triangle or -1
    at::Tensor positions_clip;  ///< [N, V, 4]; carries gradients to Geometry::positions
    int views() const { return static_cast<int>(triangle.size(0)); }
    int height() const { return static_cast<int>(triangle.size(1)); }
    int width() const { return static_cast<int>(triangle.size(2)); }
};

/// Rasterizes a geometry. behind: [N, H, W] z-depths. If given, a pixel shows the nearest surface
/// beyond its z-depth, which serves depth peeling of a transparent model.
Raster rasterize(const Geometry& geometry, const std::vector<Camera>& cameras, int width,
                 int height, const at::Tensor& behind = {});

}  // namespace item3d
