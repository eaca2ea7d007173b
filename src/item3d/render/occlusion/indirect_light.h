// Indirect light between a model's surfaces, by ray tracing.
#pragma once

#include "item3d/render/shade.h"
#include "item3d/render/textured_materials.h"

#include <cstdint>
#include <functional>
#include <memory>

namespace item3d {

class Occlusion;

struct IndirectLightOptions {
    int rays = 64;  ///< number of rays for each side of a stored point
    int bounces = 2;
    /// Same meaning as in OcclusionOptions.
    float spacing = 1.0f / 128;
    std::int64_t max_points = 16384;
    std::uint64_t seed = 0;
};

/// Store of indirect light. It holds, at grids of points over a geometry's triangles (the grids of
/// Occlusion), the radiance that leaves the surface and the mean radiance that arrives from other
/// surfaces. Reflections look up the radiance where the mirrored ray hits. The class runs on the
/// CPU and carries no gradients: an optimisation treats the stored values as constants and updates
/// them from time to time.
class IndirectLight {
  public:
    explicit IndirectLight(const Geometry& geometry, const Model* model = nullptr,
                           const IndirectLightOptions& options = {});

    /// Returns the radiance [P, 3] that leaves the surface towards its view direction, given the
    /// arriving radiance `bounce` [P, 3] (see bounce()). The raster is an image of one row, so that
    /// it suits Occlusion::at().
    using Outgoing = std::function<at::Tensor(const Raster&, const Surface&, const at::Tensor&)>;
    /// Stores the result of `outgoing` at all points, once for each bounce.
    void update(const Outgoing& outgoing);

    /// Returns the cosine-weighted mean radiance [P, 3] from other surfaces; directions that hit
    /// nothing count as 0. `raster` and `surface` must be of the constructor's geometry, whose
    /// vertices may have moved a little since then.
    at::Tensor bounce(const Raster& raster, const Surface& surface) const;

    struct Reflection {
        at::Tensor radiance;  ///< [P, 3] mean over the lobe; 0 where nothing is hit
        at::Tensor open;      ///< [P, 1] share of the lobe that hits nothing
    };
    /// Traces `rays` rays of each GGX lobe around the surface's normal. roughness: [P, 1]
    /// perceptual roughness. The result is deterministic in the seed.
    Reflection reflect(const Raster& raster, const Surface& surface, const at::Tensor& roughness,
                       int rays, std::uint64_t seed) const;

    /// Return and restore the values that update() stored, [2, points, 2, 3].
    at::Tensor stored() const;
    void restore(const at::Tensor& stored);

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// Shades with indirect light. The result is the environment's diffuse part times occlusion, plus
/// its specular part times `reflection.open`, plus the light from other surfaces. Differentiable in
/// the same inputs as shade().
at::Tensor shade_indirect(const Surface& surface, const MaterialSample& material,
                          const EnvironmentLight& light, const at::Tensor& bounce,
                          const IndirectLight::Reflection& reflection,
                          const ShadeOptions& options = {});

/// Returns the radiance that leaves the surface without its normal map: shade() plus the diffuse
/// reflection of `bounce`. The material's occlusion channel must hold the occlusion of `light`.
at::Tensor outgoing_radiance(const Surface& surface, MaterialSample material,
                             const EnvironmentLight& light, const at::Tensor& bounce);

/// Returns the indirect light of a textured model, ready for rendering. occlusion: occlusion that
/// was traced for `light`, or ambient occlusion.
std::shared_ptr<const IndirectLight> trace_indirect_light(const Geometry& geometry,
                                                          const Model& model,
                                                          const TexturedMaterials& materials,
                                                          const EnvironmentLight& light,
                                                          const Occlusion& occlusion);

}  // namespace item3d
