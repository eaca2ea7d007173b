// Occlusion of a model by itself: traced once, stored over the surface, and looked up while
// shading.
#pragma once

#include "item3d/render/shade.h"

#include <cstdint>
#include <memory>

namespace item3d {

struct OcclusionOptions {
    /// Number of rays for each side of a stored point. Large models get fewer, at least 32.
    int rays = 256;
    /// Largest distance between stored points, as a fraction of the bounding box's diagonal. It is
    /// larger if there would be more than `max_points` of them. Every vertex has a stored point.
    float spacing = 1.0f / 256;
    std::int64_t max_points = 32768;
    std::uint64_t seed = 0;
    /// Equirectangular linear radiance, RGB. With it, occlusion is the share of *this* light's
    /// irradiance that arrives, so that the sun casts soft shadows. Without it (empty), all
    /// directions count equally: ambient occlusion, usable with any light.
    Image light;
};

/// Occlusion of static geometry with constant alpha; traced on the CPU, looked up on the geometry's
/// device. A copy shares the values.
///
/// Each triangle has a grid of points whose resolution follows its size. Triangles share the points
/// of an edge where their positions and normals agree, so that smooth surfaces get smooth
/// occlusion. Every point has a value for each side of its surface, since both may be visible. Rays
/// start above the triangle's plane and cover the part of the shading normal's hemisphere above it.
/// Random numbers depend only on the seed and the point, so the result does not depend on threads.
class Occlusion {
  public:
    /// model: source of the alpha of transparent triangles (see RayScene); null: all opaque. Shows
    /// progress; throws Interrupted after Ctrl-C.
    explicit Occlusion(const Geometry& geometry, const Model* model = nullptr,
                       const OcclusionOptions& options = {});

    /// Returns [P] in [0, 1], 1 where nothing occludes (as in glTF's occlusion textures). raster
    /// and surface must be of the constructor's geometry.
    at::Tensor at(const Raster& raster, const Surface& surface) const;

    /// Returns the material with its occlusion channel multiplied by at().
    MaterialSample shadowed(const MaterialSample& material, const Raster& raster,
                            const Surface& surface) const;

    /// Returns the number of values stored for each side.
    std::int64_t points() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace item3d
