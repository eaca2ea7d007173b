// Light that a model's surfaces throw at each other: one surface in another, by rays.
#pragma once

#include "item3d/render/shade.h"
#include "item3d/render/textured_materials.h"

#include <cstdint>
#include <functional>
#include <memory>

namespace item3d {

class Occlusion;

struct IndirectLightOptions {
    int rays = 64;  ///< from each stored point on each of its sides
    int bounces = 2;
    /// Stored points, as OcclusionOptions has them.
    float spacing = 1.0f / 128;
    std::int64_t most_points = 16384;
    std::uint64_t seed = 0;
};

/// Radiance that leaves each place of a geometry is stored on grids of points over its triangles
/// (those of Occlusion), and so is the mean of what arrives there from other surfaces. What a
/// surface mirrors is looked up where the mirrored ray hits. On the CPU; without gradients: the
/// stored values are constants to an optimisation, which stores them anew from time to time.
class IndirectLight {
  public:
    explicit IndirectLight(const Geometry& geometry, const Model* model = nullptr,
                           const IndirectLightOptions& options = {});

    /// Radiance [P, 3] that leaves the surface towards its view direction, where `bounce` [P, 3]
    /// arrives (see bounce()). The raster is one row of places, for Occlusion::at().
    using Outgoing = std::function<at::Tensor(const Raster&, const Surface&, const at::Tensor&)>;
    /// Stores what `outgoing` says of all points, bounce after bounce.
    void update(const Outgoing& outgoing);

    /// [P, 3] mean radiance, by cosine, that arrives from other surfaces; directions without any
    /// count as 0. raster and surface are of the geometry that this was made for; its vertices may
    /// have moved a little since.
    at::Tensor bounce(const Raster& raster, const Surface& surface) const;

    struct Reflection {
        at::Tensor radiance;  ///< [P, 3] mean over the lobe; where nothing is hit, 0
        at::Tensor open;      ///< [P, 1] share of the lobe in which nothing is hit
    };
    /// `rays` rays of each GGX lobe around the surface's normal. roughness: [P, 1] perceptual. The
    /// same seed draws the same rays.
    Reflection reflect(const Raster& raster, const Surface& surface, const at::Tensor& roughness,
                       int rays, std::uint64_t seed) const;

    /// What update() stored, and back: [2, points, 2, 3].
    at::Tensor stored() const;
    void restore(const at::Tensor& stored);

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// shade() where surfaces light each other: of the environment, what occlusion leaves of the
/// diffuse part and `reflection.open` of the mirrored one; and what arrives from other surfaces.
/// Differentiable as shade() is.
at::Tensor shade_indirect(const Surface& surface, const MaterialSample& material,
                          const EnvironmentLight& light, const at::Tensor& bounce,
                          const IndirectLight::Reflection& reflection,
                          const ShadeOptions& options = {});

/// Radiance that leaves the surface without its normal map: shade(), and what of `bounce` its base
/// colour sends on. The material's occlusion is of the light.
at::Tensor outgoing_radiance(const Surface& surface, MaterialSample material,
                             const EnvironmentLight& light, const at::Tensor& bounce);

/// Of a textured model in a light, ready to render with. occlusion: of that light or of any.
std::shared_ptr<const IndirectLight> trace_indirect_light(const Geometry& geometry,
                                                          const Model& model,
                                                          const TexturedMaterials& materials,
                                                          const EnvironmentLight& light,
                                                          const Occlusion& occlusion);

}  // namespace item3d
