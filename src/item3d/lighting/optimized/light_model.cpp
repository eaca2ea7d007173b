#include "item3d/lighting/optimized/light_model.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/lighting/optimized/physical_light.h"
#include "item3d/lighting/optimized/texel_light.h"

namespace item3d {

const std::vector<std::string>& light_model_names() {
    static const std::vector<std::string> names = {"physical", "texels"};
    return names;
}

std::unique_ptr<LightModel> make_light_model(const Image& light, const LightModelOptions& options) {
    if (!(peak_irradiance_over_pi(light) > 0)) {
        throw InputError("the light", "is black; there is nothing to begin with",
                         "begin with another one, as --from-light studio");
    }
    if (options.kind == "texels") return std::make_unique<TexelLight>(light, options);
    if (options.kind == "physical") return std::make_unique<PhysicalLight>(light, options);
    throw InputError("--light-model", fmt::format("'{}' is not known", options.kind),
                     fmt::format("choose one of {}", fmt::join(light_model_names(), ", ")));
}

}  // namespace item3d
