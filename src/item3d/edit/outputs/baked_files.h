// The files that an edited model is in: model.glb, its layer, textures/, and its light.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/report/report.h"
#include "item3d/scene/image.h"
#include "item3d/scene/model.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// model.glb as it was written and read back: pictures and scores are of this, not of the field.
struct EditedModel {
    Model model;
    bool is_as_read = false;  ///< model is what load_model() makes of its file
    std::vector<TexturePair> textures;
    std::optional<Image> light;  ///< the new one, where the light was optimised
};

/// Name of the edited model's file: "model.glb", or "model.vrm" for an avatar.
std::string model_file_name(const std::filesystem::path& source);

/// The picture of a light that was optimised, as it is written.
Image new_light(const LightModel& light);

/// Writes model.glb, layer.safetensors and textures/; where the texture is not edited, model.glb
/// alone, with all its bytes. Where the light is, light.hdr and light.exr.
EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
