// Visibility: which triangle covers which pixel. The op boundary follows nvdiffrast (Laine et al.
// 2020, "Modular Primitives for High-Performance Differentiable Rendering").
#pragma once

#include "item3d/render/geometry.h"
#include "item3d/scene/camera.h"

#include <torch/types.h>

namespace item3d {

/// Per pixel centre of N views, row 0 at the top.
struct Raster {
    torch::Tensor
        barycentrics;        ///< [N, H, W, 2] float32 weights of the triangle's vertices 0 and 1
    torch::Tensor depth;     ///< [N, H, W] float32 distance along the view axis (z-depth), 0: none
    torch::Tensor triangle;  ///< [N, H, W] int32, index of the triangle or -1
    torch::Tensor positions_clip;  ///< [N, V, 4]; carries gradients to Geometry::positions
    int views() const { return static_cast<int>(triangle.size(0)); }
    int height() const { return static_cast<int>(triangle.size(1)); }
    int width() const { return static_cast<int>(triangle.size(2)); }
};

/// behind: [N, H, W] z-depths; a pixel then sees the nearest surface farther than that (the next
/// layer of a transparent model). Undefined: no limit.
Raster rasterize(const Geometry& geometry, const std::vector<Camera>& cameras, int width,
                 int height, const torch::Tensor& behind = {});

/// Attributes of the covered pixels alone, P in number, interpolated with perspective.
struct Surface {
    torch::Tensor pixel;     ///< [P] int64 index into N*H*W
    torch::Tensor position;  ///< [P, 3] world space
    torch::Tensor normal;    ///< [P, 3] unit shading normal, turned towards the viewer
    torch::Tensor tangent;   ///< [P, 4]
    torch::Tensor uv;        ///< [P, 2]
    /// [P, 4] d(u, v) by a pixel to the right, then by one down (uv_footprints); undefined:
    /// textures are looked up at full resolution
    torch::Tensor uv_footprint;
    torch::Tensor color;      ///< [P, 4] vertex colour
    torch::Tensor view;       ///< [P, 3] unit, from the surface to the camera
    torch::Tensor material;   ///< [P] int64 index into Model::materials
    torch::Tensor primitive;  ///< [P] int64 index into Model::primitives
    int64_t count() const { return pixel.size(0); }
};

Surface interpolate_surface(const Geometry& geometry, const Raster& raster,
                            const std::vector<Camera>& cameras);

/// How far UV coordinates change between pixels, for Surface::uv_footprint: [P, 4], exact for the
/// triangle's plane.
torch::Tensor uv_footprints(const Geometry& geometry, const Raster& raster, const Surface& surface);

/// Blends pixel pairs across silhouette edges by the edge's exact crossing (Laine et al., section
/// 3.4); differentiable in `image` [N, H, W, C] and, through raster.positions_clip, in vertices.
torch::Tensor antialias(const torch::Tensor& image, const Raster& raster, const Geometry& geometry);

}  // namespace item3d
