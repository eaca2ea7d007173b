// Models written as they are, together with a light.
#pragma once

#include "item3d/core/math.h"
#include "item3d/lighting/image_based_light.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <optional>

namespace item3d {

/// Light from very far away.
struct DirectionalLight {
    Vec3 direction{0, 1, 0};  ///< unit, towards the light, in world space
    Vec3 irradiance{1};       ///< on a plane that faces it, linear RGB, of radiance 1 = white
};

/// What shines on a model.
struct ModelLights {
    /// Becomes a node of the default scene with a directional light (KHR_lights_punctual), its
    /// intensity the irradiance: what viewers that shade a white surface with intensity / pi need
    /// to show it as item3d does.
    std::optional<DirectionalLight> sun;
    /// Becomes the default scene's image-based light (EXT_lights_image_based).
    std::optional<ImageBasedLight> surroundings;
};

/// Writes a .glb in which geometry, materials and the bytes of all pictures are those of the
/// model's glTF. Without lights a .glb that refers to no other file is copied byte for byte; models
/// of other formats are written anew. provenance: of the lights; a file with lights carries it.
void save_lit_model(const std::filesystem::path& path, const Model& model,
                    const ModelLights& lights = {}, const Provenance& provenance = {});

}  // namespace item3d
