// Shading of covered pixels: light and material to radiance.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Material values at P surface points, linear, from a texture lookup or the neural field.
struct MaterialSample {
    at::Tensor base_color;  ///< [P, 3] linear, [0, 1]
    at::Tensor orm;         ///< [P, 3] occlusion, roughness (perceptual), metallic, [0, 1]
    at::Tensor normal;      ///< [P, 3] tangent space, unit; undefined tensor: the surface's own
    at::Tensor emissive;    ///< [P, 3] linear radiance; undefined: none
    at::Tensor alpha;       ///< [P] coverage; undefined: opaque
};

struct ShadeOptions {
    /// Scales specular reflection by 1 + F0 (1 / (A + B) - 1), which compensates for light that
    /// bounces between microfacets more than once (Turquin 2019, "Practical multiple scattering
    /// compensation for microfacet models"): a white metal then reflects all light at any
    /// roughness. Off: single scattering, as in most path tracers' GGX.
    bool multiple_scattering = true;
};

/// Returns outgoing radiance [P, 3], linear; differentiable in base_color, orm, normal, the
/// surface's normal and the light's tensors:
///   base_color (1 - metallic) irradiance(n) occlusion + specular(r, roughness) (F0 A + B)
///   occlusion
///
/// with F0 = lerp(0.04, base_color, metallic), and A and B from bsdf_table(); emissive is added. r
/// is the view direction mirrored at n, turned towards n as roughness grows. A roughness below that
/// of the first specular level (0.08) uses the first level.
at::Tensor shade(const Surface& surface, const MaterialSample& material,
                 const EnvironmentLight& light, const ShadeOptions& options = {});

}  // namespace item3d
