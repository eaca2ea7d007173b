// Reading of Wavefront OBJ files as models. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/scene/model.h"

#include <filesystem>

namespace item3d {

/// Reads Wavefront OBJ with its MTL files, with one primitive for each material. Throws InputError.
Model read_obj(const std::filesystem::path& path, const Bytes& bytes,
               const LoadOptions& options = {});

}  // namespace item3d
