#include "item3d/lighting/optimized/light_model.h"

#include "item3d/core/error.h"
#include "item3d/lighting/optimized/physical_light.h"
#include "item3d/lighting/optimized/texel_light.h"

namespace item3d {

const std::vector<std::string>& light_kind_names() {
    static const std::vector<std::string> names = {"physical", "texels"};
    return names;
}

std::vector<at::Tensor> LightModel::parameters() const {
    std::vector<at::Tensor> tensors;
    for (const auto& [name, tensor] : named_parameters())
        tensors.push_back(tensor);
    return tensors;
}

std::unique_ptr<LightModel> make_light_model(const Image& light, const LightModelOptions& options) {
    if (!(peak_irradiance_over_pi(light) > 0)) {
        throw InputError("the light", "is black and cannot be the initial light",
                         "use another light, as in --from-light studio");
    }
    switch (options.kind) {
        case LightKind::physical:
            return std::make_unique<PhysicalLight>(light, options);
        case LightKind::texels:
            return std::make_unique<TexelLight>(light, options);
    }
    ITEM3D_CHECK(false, "unknown kind of light");
}

}  // namespace item3d
