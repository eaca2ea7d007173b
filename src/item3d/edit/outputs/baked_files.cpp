#include "item3d/edit/outputs/baked_files.h"

#include "item3d/core/files.h"
#include "item3d/field/bake/bake.h"
#include "item3d/io/file_names.h"
#include "item3d/io/gltf/light.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"
#include "item3d/io/texture_format.h"
#include "item3d/scene/far_origin.h"

#include <optional>
#include <span>
#include <utility>

namespace item3d {
namespace {

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
                  const std::optional<Image>& image, const ImageCoding& coding, int source_texture,
                  int bits, std::vector<TexturePair>& pairs) {
    if (!image) return;
    const auto folder = request.output / "textures";
    Bytes bytes = encode_texture(*image, coding, bits);
    write_atomically(folder / (material + "_" + suffix + extension_of(coding.encoding)),
                     std::span<const std::uint8_t>(bytes));
    pairs.push_back({title,
                     source_thumbnail(scene.model, source_texture, folder / "source.tmp.png"),
                     std::move(bytes)});
}

constexpr int light_height = 256;
/// See BakeOptions::blotch: of an edit that changes the same thing everywhere.
constexpr float recoloured_blotch = 10.0f / 255;

EditedModel bake_textures(const EditRequest& request, const EditScene& scene, EditState& state) {
    BakeOptions options;
    options.texture_size = request.plan.texture_size;
    if (request.plan.regularizes_color) options.blotch = recoloured_blotch;
    const ChannelMask& channels = scene.start.channels;
    options.channels = {channels.base_color, channels.occlusion, channels.roughness,
                        channels.metallic, channels.normal};
    const BakeScene bake_scene{scene.model, scene.geometry, *scene.textured, *scene.space,
                               scene.atlas};
    ModelEdit edit = bake(bake_scene, state.fitted, state.field, options);
    apply_losses(scene.losses, edit);
    choose_codings(scene.model, request.plan.texture_format, edit);

    EditedModel edited;
    const auto path = request.output / model_file_name(request);
    save_model(path, scene.model, edit);
    make_output_folder(request.output / "textures");
    FileNames names;
    for (const auto& [index, material_edit] : edit.materials) {
        const Material& source = scene.model.materials[static_cast<std::size_t>(index)];
        const std::string plain = plain_file_name(source.name);
        const std::string name =
            names.unused(plain.empty() ? "material" + std::to_string(index) : plain);
        const int bits = material_edit.bits_per_channel;
        save_texture(request, scene, name, "base_color", "Base colour", material_edit.base_color,
                     material_edit.base_color_coding, source.base_color_texture, bits,
                     edited.textures);
        save_texture(request, scene, name, "orm", "Occlusion, roughness, metallic",
                     material_edit.metallic_roughness, material_edit.metallic_roughness_coding,
                     source.metallic_roughness_texture, bits, edited.textures);
        save_texture(request, scene, name, "normal", "Normal", material_edit.normal,
                     material_edit.normal_coding, source.normal_texture, bits, edited.textures);
    }
    edited.model = load_model(path, {.variant = request.plan.variant});
    move_origin(edited.model, scene.model.origin);
    return edited;
}

}  // namespace

std::string model_file_name(const EditRequest& request) {
    return to_lower(request.model.extension().string()) == ".vrm" ? "model.vrm" : "model.glb";
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
