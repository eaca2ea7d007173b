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

/// A map statement: an image, with the options that stand before or after its name.
struct MtlMap {
    std::string file;  ///< as written, with / or \ as separators
    /// The name with a "#" and the text after it, which may belong to the name; empty without a
    /// "#".
    std::string file_and_comment;
    std::filesystem::path folder;  ///< folder of the MTL file
    Vec2 scale{1.0f};
    Vec2 offset{0.0f};
    bool clamp = false;
    float bump_multiplier = 1.0f;
    char channel = 0;  ///< option -imfchan: r, g, b, m(atte), l(uminance); 0 if unset
};

/// Values of a newmtl block. Members that the block does not set are empty.
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

/// Returns the file's materials by name, as written after newmtl. names: names of files and
/// materials that the file may contain, for detecting its encoding. Skips unknown lines. Throws
/// InputError if the file cannot be read.
std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path,
                                            std::vector<std::string> names);

/// Returns the text before a comment, trimmed; a "#" begins a comment if it is at the start or
/// after a blank.
std::string_view without_remark(std::string_view text);

}  // namespace item3d
