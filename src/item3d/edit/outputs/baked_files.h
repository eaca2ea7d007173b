// The files of an edited model: model.glb, its layer, textures/, and its light.
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

/// The edited model, read back from model.glb: images and scores show it, not the field.
struct EditedModel {
    Model model;
    bool is_as_read = false;  ///< model equals load_model() of its file
    std::vector<TexturePair> textures;
    std::optional<Image> light;  ///< the optimised light, if any
};

/// Name of the edited model's file: "model.glb", or "model.vrm" for an avatar.
std::string model_file_name(const std::filesystem::path& source);

/// Returns the image of an optimised light, as bake_and_save() writes it.
Image new_light(const LightModel& light);

/// Writes model.glb, layer.safetensors and textures/. Where the texture is not edited, writes
/// model.glb alone, with the source's bytes. Where the light is edited, writes light.hdr and
/// light.exr too.
EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
