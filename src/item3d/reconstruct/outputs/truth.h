// Comparison of the reconstructed materials with a dataset's reference maps.
#pragma once

#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Maps of one test view, with three channels each. The channels of a base colour are sRGB; those
/// of a material are 0, roughness and metallic.
struct MaterialMaps {
    std::string name;
    Image true_base_color, base_color;
    Image true_material, material;
};

struct MaterialTruth {
    /// PSNR of the base colour in dB, in sRGB, over pixels that both model and reference cover. The
    /// base colour is first multiplied by one factor per channel, because photographs determine
    /// base colour and light only up to such a factor.
    double base_color_psnr = 0;
    Vec3 base_color_gain{1.0f};
    /// Fraction of the pixels that both cover in which the metallic values of model and reference
    /// are on the same side of 0.5.
    double metallic_right = 0;
    double roughness_error = 0;  ///< mean absolute error
    std::vector<MaterialMaps> views;
};

/// Compares the model's materials with the images in `folder`, which has `NAME_albedo.png` (sRGB)
/// and optionally `NAME_orm.png` (roughness in green, metallic in blue) for each view. Throws
/// InputError if no view has an image, or if an image and its view differ in size.
MaterialTruth compare_materials(const Model& model, const std::vector<TargetView>& views,
                                const std::filesystem::path& folder);

}  // namespace item3d
