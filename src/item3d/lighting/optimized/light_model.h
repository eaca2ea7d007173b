// The interface of an optimised light, which converts its parameters to environment radiance.
#pragma once

#include "item3d/lighting/description.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class LightKind { physical, texels };
/// Returns the names of the kinds, in their order.
const std::vector<std::string>& light_kind_names();

class LightModel {
  public:
    virtual ~LightModel() = default;
    /// Returns [6, size, size, 3] linear radiance, with the faces of EnvironmentLight.
    /// Differentiable in the parameters.
    virtual at::Tensor cube(int size) const = 0;
    /// Returns the radiance as an equirectangular map, height x 2 height x 3, without a graph.
    virtual Image image(int height) const = 0;
    /// Returns the regularisation: a scalar, differentiable in the parameters, that keeps the light
    /// plausible in what the prior determines little. It is added without a factor to the loss L of
    /// an edit, whose gradient with respect to the latents is g (docs/method.md).
    virtual at::Tensor regularization() const = 0;
    /// Returns the parameters by their names in a checkpoint. They are leaf tensors that require
    /// gradients, of about unit scale.
    virtual NamedTensors named_parameters() const = 0;
    /// Returns the tensors of named_parameters() without names.
    std::vector<at::Tensor> parameters() const;
};

struct LightModelOptions {
    LightKind kind = LightKind::physical;
    /// Fixed direction of the brightest lobe, if the user's words specify one.
    std::optional<SkyAngles> from;
    /// Mean base colour of the lit object, linear RGB. The light should not take on this colour.
    Vec3 object_color{0.5f};
};

/// Makes a light that starts at `light` (height x width x 3, equirectangular), or its best
/// approximation. Throws InputError on a black light.
std::unique_ptr<LightModel> make_light_model(const Image& light, const LightModelOptions& options);

}  // namespace item3d
