#include "item3d/edit/outputs/baked_files.h"

#include "item3d/core/files.h"
#include "item3d/field/bake/bake.h"
#include "item3d/io/gltf/light.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"

#include <cctype>
#include <optional>

namespace item3d {
namespace {

std::string file_name_of(const std::string& material, int index) {
    std::string name;
    for (const char c : material) {
        const auto byte = static_cast<unsigned char>(c);
        name += std::isalnum(byte) != 0 || c == '-' || c == '_' ? c : '_';
    }
    return name.empty() ? "material" + std::to_string(index) : name;
}

Bytes source_thumbnail(const Model& model, int texture, const std::filesystem::path& scratch) {
    if (texture < 0) return {};
    const Image& image = model.textures[static_cast<std::size_t>(texture)].image;
    if (image.empty()) return {};
    save_image(scratch, image);
    Bytes bytes = read_bytes(scratch);
    std::filesystem::remove(scratch);
    return bytes;
}

/// Writes one image into textures/ and remembers it beside the source's for the report.
void save_texture(const EditRequest& request, const EditScene& scene, const std::string& material,
                  const std::string& suffix, const std::string& title,
                  const std::optional<Image>& image, int source_texture, int bits,
                  std::vector<TexturePair>& pairs) {
    if (!image) return;
    const auto folder = request.output / "textures";
    const auto path = folder / (material + "_" + suffix + ".png");
    save_image(path, *image, bits);
    pairs.push_back({title,
                     source_thumbnail(scene.model, source_texture, folder / "source.tmp.png"),
                     read_bytes(path)});
}

constexpr int light_height = 256;

EditedModel bake_textures(const EditRequest& request, const EditScene& scene, EditState& state) {
    BakeOptions options;
    options.texture_size = request.plan.texture_size;
    const ChannelMask& channels = request.plan.channels;
    options.channels = {channels.base_color, channels.occlusion, channels.roughness,
                        channels.metallic, channels.normal};
    const BakeScene bake_scene{scene.model, scene.geometry, *scene.textured, *scene.space,
                               scene.atlas};
    ModelEdit edit = bake(bake_scene, state.fitted, state.field, options);
    apply_losses(scene.losses, edit);

    EditedModel edited;
    const auto path = request.output / model_file_name(request);
    save_model(path, scene.model, edit);
    make_output_folder(request.output / "textures");
    for (const auto& [index, material_edit] : edit.materials) {
        const Material& source = scene.model.materials[static_cast<std::size_t>(index)];
        const std::string name = file_name_of(source.name, index);
        const int bits = material_edit.bits_per_channel;
        save_texture(request, scene, name, "base_color", "Base colour", material_edit.base_color,
                     source.base_color_texture, bits, edited.textures);
        save_texture(request, scene, name, "orm", "Occlusion, roughness, metallic",
                     material_edit.metallic_roughness, source.metallic_roughness_texture, bits,
                     edited.textures);
        save_texture(request, scene, name, "normal", "Normal", material_edit.normal,
                     source.normal_texture, bits, edited.textures);
    }
    edited.model = load_model(path, request.plan.variant);
    return edited;
}

}  // namespace

std::string model_file_name(const EditRequest& request) {
    std::string extension = request.model.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".vrm" ? "model.vrm" : "model.glb";
}

EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state) {
    const at::NoGradGuard no_grad;
    EditedModel edited;
    if (request.plan.edits_texture) {
        edited = bake_textures(request, scene, state);
    } else {
        save_lit_model(request.output / model_file_name(request), scene.model);
        edited.model = scene.model;
    }
    if (state.light) {
        edited.light = state.light->image(light_height);
        for (const char* name : {"light.hdr", "light.exr"})
            save_image(request.output / name, *edited.light, 32);
    }
    return edited;
}

}  // namespace item3d
