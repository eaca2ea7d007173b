// Shading of covered pixels: radiance from light and material.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Material values at P surface points, linear, from a texture lookup or the neural field.
struct MaterialSample {
    at::Tensor base_color;  ///< [P, 3] linear, in [0, 1]
    at::Tensor orm;         ///< [P, 3] occlusion, perceptual roughness, metallic in [0, 1]
    at::Tensor normal;      ///< [P, 3] unit, in tangent space; undefined for the surface's normal
    at::Tensor emissive;    ///< [P, 3] linear radiance; undefined without emission
    at::Tensor alpha;       ///< [P] coverage; undefined if all are opaque
};

struct ShadeOptions {
    /// Scales specular reflection by 1 + F0 (1 / (A + B) - 1). The factor compensates for light
    /// that bounces between microfacets more than once (Turquin 2019, "Practical multiple
    /// scattering compensation for microfacet models"). With it, a white metal reflects all light
    /// at any roughness. Without it, scattering is single, as in the GGX of most path tracers.
    bool multiple_scattering = true;
};

/// Returns linear outgoing radiance [P, 3]. It is differentiable in base_color, orm, normal, the
/// surface's normal and the light's tensors:
///   base_color (1 - metallic) irradiance(n) occlusion + specular(r, roughness) (F0 A + B)
///   occlusion
///
/// Here F0 = lerp(0.04, base_color, metallic), and A and B are from bsdf_table(). `emissive` is
/// added. r is the view direction mirrored at n, and turned towards n as roughness grows. A
/// roughness below that of the first specular level (0.08) uses the first level.
at::Tensor shade(const Surface& surface, const MaterialSample& material,
                 const EnvironmentLight& light, const ShadeOptions& options = {});

}  // namespace item3d
