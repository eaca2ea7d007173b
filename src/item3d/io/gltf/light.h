// Export of unedited models together with lights.
#pragma once

#include "item3d/core/math.h"
#include "item3d/lighting/image_based_light.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <optional>

namespace item3d {

/// A directional light at infinity.
struct DirectionalLight {
    Vec3 direction{0, 1, 0};  ///< unit, towards the light, in world space
    /// Irradiance of a plane that faces the light, in linear RGB. Radiance 1 is white.
    Vec3 irradiance{1};
};

/// Lights of a model.
struct ModelLights {
    /// The sun becomes a node of the default scene with a directional light (KHR_lights_punctual)
    /// whose intensity is the irradiance. Viewers that shade a white surface with intensity / pi
    /// then match item3d.
    std::optional<DirectionalLight> sun;
    /// The surroundings become the default scene's image-based light (EXT_lights_image_based).
    std::optional<ImageBasedLight> surroundings;
};

/// Writes a .glb with the geometry, materials and image bytes of the model's glTF. Without lights,
/// copies a self-contained .glb byte for byte. Converts models of other formats. provenance:
/// description of the lights; it is written only to a file with lights.
void save_lit_model(const std::filesystem::path& path, const Model& model,
                    const ModelLights& lights = {}, const Provenance& provenance = {});

}  // namespace item3d
