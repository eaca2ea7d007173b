// The light that `item3d reconstruct` found with a model.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// light.hdr beside a model.glb that `item3d reconstruct` wrote (its reconstruct.json lies there
/// too); empty for any other model.
std::filesystem::path reconstructed_light(const std::filesystem::path& model);

/// Whether an edit with these overrides of its settings is better done in such a light than in the
/// one that the prior's defaults name, if they do. Not where the texture alone is edited: a light
/// that was found is blurred, and a small prior reads materials in it badly (silver ended matt).
/// Throws as prior_defaults() does.
bool suits_found_light(const std::filesystem::path& prior, const nlohmann::json& overrides);

}  // namespace item3d
