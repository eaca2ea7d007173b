// Material libraries (MTL) of OBJ files. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// An image with the options before or after its name.
struct MtlMap {
    std::string file;              ///< as written, with / or \ as separators
    std::string file_and_comment;  ///< with a "#" that may belong to the name; else empty
    std::filesystem::path folder;  ///< of the MTL file
    Vec2 scale{1.0f};
    Vec2 offset{0.0f};
    bool clamp = false;
    float bump_multiplier = 1.0f;
    char channel = 0;  ///< of -imfchan: r, g, b, m(atte), l(uminance); 0: unset
};

/// Values of a newmtl block; members are empty where it sets nothing.
struct MtlMaterial {
    std::string name;
    std::optional<Vec3> diffuse, specular, emission;
    std::optional<float> metallic, roughness, specular_exponent;
    std::optional<float> opacity;       ///< d
    std::optional<float> transparency;  ///< Tr
    /// "bsdf pbr": nvdiffrec's dialect, in which Ks is (occlusion, roughness, metallic).
    bool is_nvdiffrec = false;
    std::optional<MtlMap> diffuse_map, metallic_map, roughness_map, specular_map, occlusion_map;
    std::optional<MtlMap> emission_map, normal_map, bump_map, opacity_map;
};

/// Returns materials by name, as written after newmtl. names: files and materials that it may
/// contain, for detecting its encoding. Throws InputError when the file cannot be read; skips
/// unknown lines.
std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path,
                                            std::vector<std::string> names);

/// Returns the text before a comment, trimmed; a "#" begins one at the start or after a blank.
std::string_view without_remark(std::string_view text);

}  // namespace item3d
