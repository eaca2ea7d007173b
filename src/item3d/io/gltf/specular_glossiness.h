// KHR_materials_pbrSpecularGlossiness as metallic-roughness. Internal to io.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>

namespace item3d {

/// Linear values of the older model; pictures as they are in files (sRGB colours, alpha and
/// glossiness linear).
struct SpecularGlossiness {
    Vec4 diffuse_factor{1.0f};
    Vec3 specular_factor{1.0f};
    float glossiness_factor = 1.0f;
    const Image* diffuse = nullptr;              ///< RGB or RGBA
    const Image* specular_glossiness = nullptr;  ///< RGBA
};

/// The metallic-roughness material that reflects as much: factors, and pictures where the values
/// differ from texel to texel.
struct MetallicRoughness {
    Vec4 base_color_factor{1.0f};
    float metallic_factor = 0.0f;
    float roughness_factor = 1.0f;
    /// Not set: the diffuse picture serves as it is.
    std::optional<Image> base_color;
    std::optional<Image> metallic_roughness;
};

/// A dielectric keeps its diffuse colour; where the specular colour is brighter than that of any
/// (0.04), the material is metal to the degree that gives diffuse and specular colour back.
MetallicRoughness to_metallic_roughness(const SpecularGlossiness& source);

}  // namespace item3d
