// A light that is optimised: numbers in, radiance from all around out.
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
/// Their names, in their order.
const std::vector<std::string>& light_kind_names();

class LightModel {
  public:
    virtual ~LightModel() = default;
    /// [6, size, size, 3] linear radiance, faces as of EnvironmentLight; differentiable in the
    /// parameters.
    virtual at::Tensor cube(int size) const = 0;
    /// The same as an equirectangular map, height x 2 height x 3, without a graph.
    virtual Image image(int height) const = 0;
    /// What keeps the light plausible where guidance says little: a scalar, differentiable in the
    /// parameters, that is added as it is to the loss whose gradient by the latents is g
    /// (docs/method.md).
    virtual at::Tensor regularization() const = 0;
    /// Leaves that require gradients, of about unit scale, by the names that a checkpoint has.
    virtual NamedTensors named_parameters() const = 0;
    /// The same without names.
    std::vector<at::Tensor> parameters() const;
};

struct LightModelOptions {
    LightKind kind = LightKind::physical;
    /// Where the light must come from: words said so. The brightest lobe is held there.
    std::optional<SkyAngles> from;
    /// Mean base colour of what is lit, linear RGB: colours that the light is not to take on.
    Vec3 object_color{0.5f};
};

/// Starts at `light` (height x width x 3, equirectangular), or as near to it as the model can be.
/// Throws InputError on a black light.
std::unique_ptr<LightModel> make_light_model(const Image& light, const LightModelOptions& options);

}  // namespace item3d
