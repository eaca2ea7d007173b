#include "item3d/edit/outputs/baked_files.h"

#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/edit/outputs/bake_options.h"
#include "item3d/edit/outputs/edit_claim.h"
#include "item3d/edit/outputs/layer_file.h"
#include "item3d/field/bake/bake.h"
#include "item3d/io/file_names.h"
#include "item3d/io/gltf/light.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"
#include "item3d/io/texture_format.h"
#include "item3d/report/animation.h"
#include "item3d/report/display_image.h"
#include "item3d/scene/far_origin.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace item3d {
namespace {

/// Longest edge of the report's images of textures, in pixels.
constexpr int thumbnail_edge = 512;

Bytes source_thumbnail(const Model& model, int texture) {
    if (texture < 0) return {};
    const Image& image = model.textures[static_cast<std::size_t>(texture)].image;
    return image.empty() ? Bytes() : encode_webp(thumbnail(image, thumbnail_edge));
}

/// Writes the baked images into textures/, each once, and pairs them with the source's images for
/// the report.
class TextureFolder {
  public:
    TextureFolder(std::filesystem::path folder, const Model& source,
                  std::vector<TexturePair>& pairs)
        : folder_(std::move(folder)), source_(source), pairs_(pairs) {}

    void save(const EditedTexture& texture, const std::string& material, const char* suffix,
              const char* title, int source_texture) {
        if (!texture || !seen_.insert(texture.identity()).second) return;
        write_atomically(
            folder_ / (material + "_" + suffix + extension_of(texture.coding().encoding)),
            std::span<const std::uint8_t>(texture.encoded()));
        pairs_.push_back({title, source_thumbnail(source_, source_texture),
                          encode_webp(thumbnail(*texture, thumbnail_edge))});
    }

  private:
    std::filesystem::path folder_;
    const Model& source_;
    std::vector<TexturePair>& pairs_;
    std::set<const void*> seen_;
};

void note_vertex_colors(const Model& model, const ModelEdit& edit) {
    for (const auto& [index, material] : edit.materials) {
        if (!material.base_color || !material.includes_vertex_colors) continue;
        note("material '" + model.materials[static_cast<std::size_t>(index)].name +
             "': its vertex colours were baked into its base colour texture");
    }
}

/// Returns a small field for a bake of painted colours. The field changes nothing and is evaluated
/// quickly.
NeuralTexture empty_field() {
    NeuralTextureOptions options;
    options.levels = 1;
    options.log2_table_size = 8;
    return NeuralTexture(options);
}

constexpr int light_height = 256;

EditedModel bake_textures(const EditRequest& request, const EditScene& scene, EditState& state) {
    const BakeOptions options = bake_options(request.plan, scene.start.channels);
    BakeScene bake_scene{scene.model, scene.geometry, *scene.textured, *scene.space, scene.atlas};
    if (scene.region)
        bake_scene.weight = [&](const Surface& surface) { return scene.region->weight(surface); };
    std::map<int, UneditedImages> unedited;
    std::map<int, Image> painted;
    if (state.painter) {
        painted = state.painting->texels->images(state.painter->colors());
        bake_scene.painted = &painted;
    }
    NeuralTexture none = state.painter ? empty_field() : NeuralTexture(nullptr);
    NeuralTexture& fitted = state.painter ? none : state.fitted;
    NeuralTexture& field = state.painter ? none : state.field;
    ModelEdit edit = bake(bake_scene, fitted, field, options, state.painter ? nullptr : &unedited);
    apply_losses(scene.losses, edit);
    note_vertex_colors(scene.model, edit);
    choose_codings(scene.model, request.plan.texture_format, edit);

    EditedModel edited;
    const auto path = request.output / model_file_name(request.model);
    save_model(path, scene.model, edit, provenance_of(request, state));
    if (!state.painter) write_layer_file(request, scene, state, edit, unedited);
    unedited.clear();
    make_output_folder(request.output / "textures");
    TextureFolder folder(request.output / "textures", scene.model, edited.textures);
    FileNames names;
    for (const auto& [index, material_edit] : edit.materials) {
        const Material& source = scene.model.materials[static_cast<std::size_t>(index)];
        const std::string plain = plain_file_name(source.name);
        const std::string name =
            names.unused(plain.empty() ? "material" + std::to_string(index) : plain);
        folder.save(material_edit.base_color, name, "base_color", "Base colour",
                    source.base_color_texture);
        folder.save(material_edit.metallic_roughness, name, "orm", "Occlusion, roughness, metallic",
                    source.metallic_roughness_texture);
        folder.save(material_edit.normal, name, "normal", "Normal", source.normal_texture);
    }
    edited.model = load_model(
        path, {.texture_folders = request.texture_folders, .variant = request.plan.variant});
    edited.is_as_read = edited.model.origin == scene.model.origin;
    move_origin(edited.model, scene.model.origin);
    return edited;
}

}  // namespace

std::string model_file_name(const std::filesystem::path& source) {
    return to_lower(source.extension().string()) == ".vrm" ? "model.vrm" : "model.glb";
}

Image new_light(const LightModel& light) {
    return light.image(light_height);
}

EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state) {
    const at::NoGradGuard no_grad;
    EditedModel edited;
    if (request.plan.edits_texture) {
        edited = bake_textures(request, scene, state);
    } else {
        save_lit_model(request.output / model_file_name(request.model), scene.model);
        edited.model = scene.model;
    }
    if (state.light) {
        edited.light = new_light(*state.light);
        for (const char* name : {"light.hdr", "light.exr"})
            save_image(request.output / name, *edited.light, 32);
    }
    return edited;
}

}  // namespace item3d
