// Conversion of KHR_materials_pbrSpecularGlossiness to metallic-roughness. Internal to io.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>

namespace item3d {

/// Values of a specular-glossiness material. Factors are linear. Images are as in files: colours
/// are sRGB-encoded, alpha and glossiness are linear.
struct SpecularGlossiness {
    Vec4 diffuse_factor{1.0f};
    Vec3 specular_factor{1.0f};
    float glossiness_factor = 1.0f;
    const Image* diffuse = nullptr;              ///< RGB or RGBA
    const Image* specular_glossiness = nullptr;  ///< RGBA
};

/// A metallic-roughness material of the same reflectance. It has images only for values that vary
/// over the surface.
struct MetallicRoughness {
    Vec4 base_color_factor{1.0f};
    float metallic_factor = 0.0f;
    float roughness_factor = 1.0f;
    /// Has no value if the diffuse image is used unchanged.
    std::optional<Image> base_color;
    std::optional<Image> metallic_roughness;
};

/// Converts a material. A dielectric keeps its diffuse colour; where the specular colour is
/// brighter than a dielectric's (0.04), the material is metallic to the degree that reproduces both
/// colours.
MetallicRoughness to_metallic_roughness(const SpecularGlossiness& source);

}  // namespace item3d
