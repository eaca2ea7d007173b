// The light that `item3d reconstruct` found with a model.
#pragma once

#include <filesystem>

namespace item3d {

/// light.hdr beside a model.glb that `item3d reconstruct` wrote (its reconstruct.json lies there
/// too); empty for any other model.
std::filesystem::path reconstructed_light(const std::filesystem::path& model);

}  // namespace item3d
