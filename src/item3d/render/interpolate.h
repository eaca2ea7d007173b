// The attributes of a geometry at the pixels that it covers.
#pragma once

#include "item3d/render/rasterize.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Attributes of the covered pixels alone, P in number, interpolated with perspective.
struct Surface {
    at::Tensor pixel;     ///< [P] int64 index into N*H*W
    at::Tensor position;  ///< [P, 3] world space
    at::Tensor normal;    ///< [P, 3] unit shading normal, turned towards the viewer
    at::Tensor tangent;   ///< [P, 4]
    at::Tensor uv;        ///< [P, 2]
    /// [P, 4] d(u, v) by a pixel to the right, then by one down (uv_footprints); undefined:
    /// textures are looked up at full resolution
    at::Tensor uv_footprint;
    std::vector<at::Tensor> further_uvs;            ///< [P, 2] each, of Geometry::further_uvs
    std::vector<at::Tensor> further_uv_footprints;  ///< [P, 4] each; empty as uv_footprint is
    at::Tensor color;                               ///< [P, 4] vertex colour
    at::Tensor view;                                ///< [P, 3] unit, from the surface to the camera
    at::Tensor material;                            ///< [P] int64 index into Model::materials
    at::Tensor primitive;                           ///< [P] int64 index into Model::primitives
    at::Tensor triangle;                            ///< [P] int64 index into Geometry::triangles
    std::int64_t count() const { return pixel.size(0); }
};

Surface interpolate_surface(const Geometry& geometry, const Raster& raster,
                            const std::vector<Camera>& cameras);

/// How far UV coordinates change between pixels, for Surface::uv_footprint: [P, 4], exact for the
/// triangle's plane.
at::Tensor uv_footprints(const Geometry& geometry, const Raster& raster, const Surface& surface);

/// Sets the surface's footprints of all its UV maps.
void add_uv_footprints(const Geometry& geometry, const Raster& raster, Surface& surface);

}  // namespace item3d
