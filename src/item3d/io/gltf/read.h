// glTF 2.0 files to models. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <string>

namespace item3d {

/// glTF 2.0, binary or JSON. variant: as load_model() has it. Throws InputError.
Model read_gltf(const std::filesystem::path& path, const Bytes& bytes,
                const std::string& variant = "");

}  // namespace item3d
