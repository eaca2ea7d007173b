// Conversion of KHR_materials_pbrSpecularGlossiness to metallic-roughness. Internal to io.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>

namespace item3d {

/// Linear values of the older model; images as in files (sRGB colours, alpha and glossiness
/// linear).
struct SpecularGlossiness {
    Vec4 diffuse_factor{1.0f};
    Vec3 specular_factor{1.0f};
    float glossiness_factor = 1.0f;
    const Image* diffuse = nullptr;              ///< RGB or RGBA
    const Image* specular_glossiness = nullptr;  ///< RGBA
};

/// A metallic-roughness material of the same reflectance: factors, and images where values vary.
struct MetallicRoughness {
    Vec4 base_color_factor{1.0f};
    float metallic_factor = 0.0f;
    float roughness_factor = 1.0f;
    /// Not set: the diffuse image is used unchanged.
    std::optional<Image> base_color;
    std::optional<Image> metallic_roughness;
};

/// Converts a material. A dielectric keeps its diffuse colour; where the specular colour is
/// brighter than a dielectric's (0.04), the material is metallic to the degree that reproduces both
/// colours.
MetallicRoughness to_metallic_roughness(const SpecularGlossiness& source);

}  // namespace item3d
