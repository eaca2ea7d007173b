// The light that `item3d reconstruct` estimated with a model.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Returns light.hdr beside a model.glb that `item3d reconstruct` wrote (which has a
/// reconstruct.json beside it); empty for any other model.
std::filesystem::path reconstructed_light(const std::filesystem::path& model);

/// True if an edit with these overrides should use the estimated light in place of the one that the
/// prior's defaults name. False where the texture alone is edited: an estimated light is blurred,
/// and under it a small prior misjudges materials (silver became matt). Throws as prior_defaults().
bool suits_found_light(const std::filesystem::path& prior, const nlohmann::json& overrides);

}  // namespace item3d
