// Occlusion of a model by itself. It is traced once, stored over the surface, and looked up while
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
    /// increased if there would be more than `max_points` points. Every vertex has a stored point.
    float spacing = 1.0f / 256;
    std::int64_t max_points = 32768;
    std::uint64_t seed = 0;
    /// Equirectangular linear radiance, RGB. With a light, occlusion is the share of this light's
    /// irradiance that arrives, so that the sun casts soft shadows. If the image is empty, all
    /// directions count equally. The result is ambient occlusion, which suits any light.
    Image light;
};

/// Occlusion of static geometry with constant alpha. It is traced on the CPU, and looked up on the
/// geometry's device. A copy shares the values.
///
/// Each triangle has a grid of points whose resolution follows its size. Triangles share the points
/// of an edge where their positions and normals agree, so that smooth surfaces get smooth
/// occlusion. Every point has a value for each side of its surface, since both may be visible. Rays
/// start above the triangle's plane. They cover the part of the shading normal's hemisphere that
/// lies above this plane. Random numbers depend only on the seed and the point, so the result does
/// not depend on threads.
class Occlusion {
  public:
    /// model: source of the alpha of transparent triangles (see RayScene); if null, all triangles
    /// are opaque. Shows progress. Throws Interrupted after Ctrl-C.
    explicit Occlusion(const Geometry& geometry, const Model* model = nullptr,
                       const OcclusionOptions& options = {});

    /// Returns values [P] in [0, 1], which are 1 where nothing occludes, as in glTF's occlusion
    /// textures. `raster` and `surface` must be of the constructor's geometry.
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
