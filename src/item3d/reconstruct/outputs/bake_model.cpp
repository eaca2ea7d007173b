#include "item3d/field/bake/bake.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/reconstruct/outputs/outputs.h"
#include "item3d/reconstruct/surface/plain_model.h"

namespace item3d {

Model bake_and_save(const std::filesystem::path& file, const Model& model, Appearance& appearance,
                    const ReconstructRequest& request) {
    const torch::NoGradGuard no_gradient;
    Model neutral = model;
    set_constant_material(neutral, appearance.field->options().ranges);
    NeuralTexture fitted = constant_field(appearance.field->options());
    const Geometry geometry = Geometry::from_model(neutral);
    const TexturedMaterials materials(neutral);
    const FieldSpace space(neutral, {0});
    const Atlas atlas = make_atlas(neutral, space, {0}, request.texture_size);
    BakeOptions options;
    options.texture_size = request.texture_size;
    // Shadows are the renderer's business: a baked occlusion would darken the model a second time.
    options.channels = {.base_color = true,
                        .occlusion = false,
                        .roughness = true,
                        .metallic = true,
                        .normal = request.refine.normal_map};
    const ModelEdit edit =
        bake({neutral, geometry, materials, space, atlas}, fitted, appearance.field, options);
    save_model(file, neutral, edit);
    return load_model(file);
}

}  // namespace item3d
