// Loading of models and images. Every function throws InputError for unusable input. No function
// reads outside the model's folder, or allocates memory out of proportion to the file's size.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// File name extensions of the formats that load_model() reads.
inline constexpr std::array<std::string_view, 4> model_extensions = {".glb", ".gltf", ".vrm",
                                                                     ".obj"};

/// True for a path with one of model_extensions, in upper or lower case.
bool is_model_file(const std::filesystem::path& path);

/// Returns ".glb, .gltf, .vrm or .obj", for help and messages.
std::string model_extensions_text();

struct LoadOptions {
    /// Additional folders from which textures may be read.
    std::vector<std::filesystem::path> texture_folders = {};
    /// Name of one of Model::variants to show instead of the default; an unknown name throws an
    /// InputError that lists the file's variants.
    std::string variant = {};
};

/// Loads glTF 2.0 (.glb, .gltf, .vrm) or OBJ with MTL. Content and extension decide the format.
/// Warns of an unreadable texture (the material's factor alone is then used) and of an invisible
/// model. Throws InputError for a model without triangles, with non-finite positions, or of a size
/// outside 1e-7 to 1e15.
Model load_model(const std::filesystem::path& path, const LoadOptions& options = {});

/// Loads PNG, JPEG, WebP, KTX2 (Basis Universal), BMP, TGA, GIF, TIFF, Radiance HDR or OpenEXR; the
/// content decides the format. Keeps the file's channels. Palettes are expanded; 1-bit and 16-bit
/// values are scaled to [0, 1].
Image load_image(const std::filesystem::path& path);

}  // namespace item3d
