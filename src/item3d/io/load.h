// Files to models and images. Every function throws InputError for what can't be used; none reads
// outside the model's folder, none allocates out of proportion to the file.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct LoadOptions {
    /// Folders beside the model's own that textures may be read from.
    std::vector<std::filesystem::path> texture_folders = {};
    /// The name of one of Model::variants, which is shown instead of what the file shows by itself;
    /// an InputError lists those that there are.
    std::string variant = {};
};

/// glTF 2.0 (.glb, .gltf) or OBJ with MTL, by content and extension. A texture that cannot be read
/// is a warning (the factor is used). A model without triangles or with non-finite positions is an
/// InputError, one of which nothing can be seen a warning.
Model load_model(const std::filesystem::path& path, const LoadOptions& options = {});

/// PNG, JPEG, WebP, KTX2 (Basis Universal), BMP, TGA, GIF, TIFF, Radiance HDR, OpenEXR, by content.
/// Channels as in the file (palettes are expanded,
/// 1-bit and 16-bit scaled to [0, 1]).
Image load_image(const std::filesystem::path& path);

}  // namespace item3d
