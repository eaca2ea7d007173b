// The light that `item3d reconstruct` estimated with a model.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Returns the path of light.hdr beside a model.glb that `item3d reconstruct` wrote. Such a model
/// has a reconstruct.json beside it. Empty for any other model.
std::filesystem::path reconstructed_light(const std::filesystem::path& model);

/// True if an edit with these overrides should use the estimated light instead of the light that
/// the prior's defaults name. False if the edit changes only the texture, because an estimated
/// light is blurred, and in it a small prior misjudges materials (silver became matt). Throws as
/// prior_defaults().
bool suits_found_light(const std::filesystem::path& prior, const nlohmann::json& overrides);

}  // namespace item3d
