// Command item3d layers: applies the changes of several edits to a model, at any strength.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/model_options.h"
#include "apps/item3d/sign_key_option.h"
#include "item3d/core/format.h"
#include "item3d/edit/outputs/rebake_layer.h"
#include "item3d/io/load.h"
#include "item3d/layers/layered_model.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

struct LayersCommand : CommonOptions {
    LayeredModelRequest request;
    std::vector<std::string> layers;
    std::string texture_format;
    SignKeyOption sign_key;
};

const std::vector<std::pair<std::string, TextureFormat>> layer_formats = {
    {"keep", TextureFormat::keep},
    {"png", TextureFormat::png},
    {"jpeg", TextureFormat::jpeg},
    {"webp", TextureFormat::webp},
    {"ktx2", TextureFormat::ktx2}};

void run_layers(LayersCommand& options) {
    LayeredModelRequest& request = options.request;
    for (const std::string& text : options.layers)
        request.layers.push_back(parse_layer_use(text));
    for (const auto& [name, format] : layer_formats)
        if (name == options.texture_format) request.texture_format = format;
    request.sign_key = options.sign_key.load();
    start_command(options);
    const nlohmann::json record = write_layered_model(request);
    if (options.json)
        print_json(record);
    else
        fmt::print("{}\n", request.output.string());
}

}  // namespace

void add_layers_command(CLI::App& app) {
    auto options = std::make_shared<LayersCommand>();
    CLI::App* command = add_command(app, "layers", *options);
    LayeredModelRequest& request = options->request;
    command
        ->add_option("MODEL", request.model,
                     "The model that was edited: " + model_extensions_text())
        ->required();
    command
        ->add_option("LAYER", options->layers,
                     "LAYER[:STRENGTH[:CHANNEL,...]]: a layer.safetensors or the folder of an "
                     "edit; a strength from -1 to 2 (default 1: as edited; 0: no effect); channels "
                     "of base_color, occlusion, roughness, metallic, normal (default: all)")
        ->required();
    command->add_option("-o,--output", request.output, "Model to write: .glb, .vrm, .gltf or .obj")
        ->type_name("FILE")
        ->required();
    add_texture_folders(*command, request.texture_folders);
    add_sign_key(*command, options->sign_key);
    command
        ->add_option("--texture-format", options->texture_format,
                     "Format of the written textures. Default: that of the edits")
        ->check(CLI::IsMember({"keep", "png", "jpeg", "webp", "ktx2"}));
    command
        ->add_option("--texture-size", request.texture_size,
                     "Longest edge of the changed textures, in pixels, which are then baked again. "
                     "Default: unchanged")
        ->check(CLI::Range(16, 8192));
    request.rebake = rebake_layer;
    command->footer(
        "The result is the model's textures plus the sum of strength times difference, rounded "
        "once.\n"
        "One layer at strength 1 gives the edit's own model.glb, strength 0 the unchanged model.\n"
        "Layers with another texture size or UV map are baked again from their neural fields.");
    command->callback([options] { run_layers(*options); });
}

}  // namespace item3d
