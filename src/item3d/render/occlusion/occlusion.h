// How much of the light around reaches each point of a model past the model itself: traced once,
// stored over the surface, and looked up while shading.
#pragma once

#include "item3d/render/shade.h"

#include <cstdint>
#include <memory>

namespace item3d {

struct OcclusionOptions {
    /// Rays from each stored point on each of its sides. Large models get fewer, at least 32.
    int rays = 256;
    /// Stored points are at most this part of the diagonal of the model's box apart, unless there
    /// would be more than `most_points` of them then. Vertices always have one.
    float spacing = 1.0f / 256;
    std::int64_t most_points = 32768;
    std::uint64_t seed = 0;
    /// Equirectangular linear radiance, RGB. With it, occlusion is the share of *this* light's
    /// irradiance that arrives, so that the sun casts soft shadows. Without it (empty), all
    /// directions count alike: ambient occlusion, good for any light.
    Image light;
};

/// Precomputed for geometry that does not move, and materials whose alpha does not change; traced
/// on the CPU, looked up on the geometry's device. A copy shares the values.
///
/// Each triangle has a grid of points as fine as it is large, shared along edges where positions
/// and normals agree, so that smooth surfaces get smooth occlusion. Every point has a value for
/// each side of its surface, since both may be seen. Rays start above the triangle's plane and go
/// where the shading normal's hemisphere is above that plane. Random numbers depend on the seed and
/// on the point alone: threads do not change the result.
class Occlusion {
  public:
    /// model: where transparent triangles get their alpha from (see RayScene); null: all opaque.
    /// Shows progress; throws Interrupted after Ctrl-C.
    explicit Occlusion(const Geometry& geometry, const Model* model = nullptr,
                       const OcclusionOptions& options = {});

    /// [P] in [0, 1], 1 where nothing is in the way (as glTF's occlusion textures have it). raster
    /// and surface are of the geometry that this was made for.
    at::Tensor at(const Raster& raster, const Surface& surface) const;

    /// The material with its occlusion channel multiplied by at().
    MaterialSample shadowed(const MaterialSample& material, const Raster& raster,
                            const Surface& surface) const;

    /// Values stored for each side.
    std::int64_t points() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace item3d
