// Vertex attributes of a geometry, interpolated at the covered pixels.
#pragma once

#include "item3d/render/rasterize.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Perspective-correct attributes of the P covered pixels.
struct Surface {
    at::Tensor pixel;     ///< [P] int64 index into N*H*W
    at::Tensor position;  ///< [P, 3] world space
    at::Tensor normal;    ///< [P, 3] unit shading normal on the viewer's side
    at::Tensor tangent;   ///< [P, 4]
    at::Tensor uv;        ///< [P, 2]
    /// [P, 4] change of (u, v) from a pixel to the next one on the right, then to the next one
    /// below (uv_footprints). If undefined, textures are looked up at full resolution.
    at::Tensor uv_footprint;
    std::vector<at::Tensor> further_uvs;            ///< [P, 2] each, of Geometry::further_uvs
    std::vector<at::Tensor> further_uv_footprints;  ///< [P, 4] each; empty without uv_footprint
    at::Tensor color;                               ///< [P, 4] vertex colour
    /// [P, 3] unit vector from the surface to the camera.
    at::Tensor view;
    at::Tensor material;   ///< [P] int64 index into Model::materials
    at::Tensor primitive;  ///< [P] int64 index into Model::primitives
    at::Tensor triangle;   ///< [P] int64 index into Geometry::triangles
    std::int64_t count() const { return pixel.size(0); }
};

Surface interpolate_surface(const Geometry& geometry, const Raster& raster,
                            const std::vector<Camera>& cameras);

/// Returns the changes of the UV coordinates between pixels, [P, 4], for Surface::uv_footprint.
/// They are exact for the triangle's plane.
at::Tensor uv_footprints(const Geometry& geometry, const Raster& raster, const Surface& surface);

/// Sets the footprints of all of the surface's UV maps.
void add_uv_footprints(const Geometry& geometry, const Raster& raster, Surface& surface);

}  // namespace item3d
