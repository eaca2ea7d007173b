// Comparison of the reconstructed materials with a dataset's reference maps.
#pragma once

#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Maps of one test view, three channels each: base colour sRGB, material (0, roughness, metallic).
struct MaterialMaps {
    std::string name;
    Image true_base_color, base_color;
    Image true_material, material;
};

struct MaterialTruth {
    /// PSNR in dB, sRGB, over pixels covered by both, after one factor per channel: photographs
    /// determine base colour and light only up to such a factor.
    double base_color_psnr = 0;
    Vec3 base_color_gain{1.0f};
    /// Fraction of these pixels whose metallic is on the same side of 0.5.
    double metallic_right = 0;
    double roughness_error = 0;  ///< mean absolute error
    std::vector<MaterialMaps> views;
};

/// Compares with `folder`, which has for each view `NAME_albedo.png` (sRGB) and optionally
/// `NAME_orm.png` (roughness in green, metallic in blue). Throws InputError if no view has an
/// image, or one is of another size.
MaterialTruth compare_materials(const Model& model, const std::vector<TargetView>& views,
                                const std::filesystem::path& folder);

}  // namespace item3d
