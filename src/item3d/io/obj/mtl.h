// Material libraries of OBJ files. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace item3d {

/// A picture with the options that stood before its name.
struct MtlMap {
    std::string file;  ///< as written: bytes, any separators
    Vec2 scale{1.0f};
    Vec2 offset{0.0f};
    bool clamp = false;
    float bump_multiplier = 1.0f;
};

/// What a newmtl block says; members are empty where it says nothing.
struct MtlMaterial {
    std::string name;
    std::optional<Vec3> diffuse, specular, emission;
    std::optional<float> metallic, roughness, specular_exponent, opacity;
    /// "bsdf pbr": nvdiffrec's dialect, in which Ks is (occlusion, roughness, metallic).
    bool is_nvdiffrec = false;
    std::optional<MtlMap> diffuse_map, metallic_map, roughness_map, specular_map, occlusion_map;
    std::optional<MtlMap> emission_map, normal_map, bump_map, opacity_map;
};

/// By name. Throws InputError when the file cannot be read; lines it does not know are skipped.
std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path);

}  // namespace item3d
