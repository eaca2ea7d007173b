// EXT_lights_image_based: image-based lights in glTF documents.
#pragma once

#include "item3d/lighting/image_based_light.h"

#include <filesystem>

namespace item3d {

class GltfBuilder;

inline constexpr const char* image_based_extension = "EXT_lights_image_based";

/// Adds the light with its images; returns its index among the document's image-based lights.
///
/// Images are PNGs in RGBD: RGB = (D radiance)^(1 / 2.2) and A = D = floor(255 / max(radiance, 1))
/// / 255. The extension does not define the encoding of RGB; item3d uses the encoding that
/// Babylon.js, the first implementation, reads. RGBD cannot represent radiance above 255. The
/// light's `intensity` scales the prefiltered levels into this range. The first level is clipped,
/// for instance at a sun's disk; the other levels contain the sun's energy.
std::size_t add_image_based_light(GltfBuilder& builder, const ImageBasedLight& light);

/// Loads the image-based light of the scene in a .glb or .gltf; if the scene has none, the first
/// one of the file. Returns the light's finest level as an equirectangular light, with its rotation
/// and intensity applied. Throws InputError if the file has no image-based light.
Image load_image_based_light(const std::filesystem::path& path);

}  // namespace item3d
