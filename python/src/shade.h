// Split-sum shading under a prefiltered light.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Common parameters of shading P points under a light of L levels.
///
///   base_color, normal, view  [P, 3]
///   orm                       [P, 3] occlusion, roughness, metallic
///   normal_map                [P, 3] in tangent space; requires a tangent [P, 4]
///   diffuse                   [6, D, D, 3]
///   specular                  [6, S, S, 3] each; S differs between levels
///   roughness                 [L], ascending
struct ShadeInput {
    const Tensor& base_color;
    const Tensor& orm;
    const std::optional<Tensor>& normal_map;
    const Tensor& normal;
    const std::optional<Tensor>& tangent;
    const Tensor& view;
    const Tensor& diffuse;
    const std::vector<Tensor>& specular;
    const Tensor& roughness;
    bool multiple_scattering;
};

/// Returns linear radiance [P, 3]. It is zero where the normal, the normal map or the view has no
/// length. Throws std::runtime_error.
Tensor shade(const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
             const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
             const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
             bool multiple_scattering);

/// Returns the gradients with respect to base_color, orm, normal_map (of shape [0] without a normal
/// map) and normal, and one flat tensor that concatenates those with respect to diffuse and all
/// levels. The first four have shape [0] if `points_wanted` is false, the last if `light_wanted` is
/// false.
std::tuple<Tensor, Tensor, Tensor, Tensor, Tensor> shade_backward(
    const Tensor& base_color, const Tensor& orm, const std::optional<Tensor>& normal_map,
    const Tensor& normal, const std::optional<Tensor>& tangent, const Tensor& view,
    const Tensor& diffuse, const std::vector<Tensor>& specular, const Tensor& roughness,
    bool multiple_scattering, const Tensor& gradient, bool points_wanted, bool light_wanted);

}  // namespace item3d::python
