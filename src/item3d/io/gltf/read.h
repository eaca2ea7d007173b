// Reading of glTF 2.0 files as models. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <string>

namespace item3d {

/// Reads glTF 2.0, binary or JSON. Throws InputError.
Model read_gltf(const std::filesystem::path& path, const Bytes& bytes,
                const LoadOptions& options = {});

}  // namespace item3d
