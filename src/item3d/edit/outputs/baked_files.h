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

/// The edited model, read back from model.glb. Images and scores are of this model and not of the
/// field.
struct EditedModel {
    Model model;
    bool is_as_read = false;  ///< true if `model` equals load_model() of its file
    std::vector<TexturePair> textures;
    std::optional<Image> light;  ///< the optimised light, if any
};

/// Returns the name of the edited model's file: "model.glb", or "model.vrm" for an avatar.
std::string model_file_name(const std::filesystem::path& source);

/// Returns the image of an optimised light, as bake_and_save() writes it.
Image new_light(const LightModel& light);

/// Writes model.glb, layer.safetensors and textures/. If the edit does not change the texture,
/// writes only model.glb, with the source's bytes. If the edit changes the light, also writes
/// light.hdr and light.exr.
EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
