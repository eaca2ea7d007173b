// EXT_lights_image_based: image-based lights in glTF documents.
#pragma once

#include "item3d/lighting/image_based_light.h"

#include <filesystem>

namespace item3d {

class GltfBuilder;

inline constexpr const char* image_based_extension = "EXT_lights_image_based";

/// Adds the light with its pictures; returns its index among the document's image-based lights.
///
/// Pictures are PNGs in RGBD: RGB = (D radiance)^(1 / 2.2) and A = D = floor(255 / max(radiance,
/// 1)) / 255. The extension leaves open how RGB is encoded; that is what Babylon.js, which has had
/// it from the beginning, reads. What is more than 255 times as bright as white does not fit: the
/// light's `intensity` makes room for the prefiltered levels, and the first is clipped (a sun's
/// disk, of which the others hold the energy).
std::size_t add_image_based_light(GltfBuilder& builder, const ImageBasedLight& light);

/// The image-based light of a .glb's or .gltf's scene, or the first there is, in its finest level
/// as an equirectangular light; rotation and intensity are applied. Throws InputError where the
/// file has none.
Image load_image_based_light(const std::filesystem::path& path);

}  // namespace item3d
