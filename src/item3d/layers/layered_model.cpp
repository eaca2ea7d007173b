#include "item3d/layers/layered_model.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/overwrite.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"
#include "item3d/layers/apply_layers.h"
#include "item3d/layers/layer_fit.h"
#include "item3d/tensors/checkpoint.h"

#include <algorithm>
#include <span>

namespace item3d {
namespace {

using nlohmann::json;

constexpr std::pair<const char*, TextureFormat> formats[] = {{"keep", TextureFormat::keep},
                                                             {"png", TextureFormat::png},
                                                             {"jpeg", TextureFormat::jpeg},
                                                             {"webp", TextureFormat::webp},
                                                             {"ktx2", TextureFormat::ktx2}};

std::string setting_of(const EditLayer& layer, const char* name) {
    const json& settings = layer.settings;
    const auto found = settings.is_object() ? settings.find(name) : settings.end();
    return found != settings.end() && found->is_string() ? found->get<std::string>() : "";
}

TextureFormat format_of(const std::vector<AppliedLayer>& layers) {
    std::optional<std::string> agreed;
    for (const AppliedLayer& applied : layers) {
        if (applied.use.strength == 0) continue;
        const std::string own = setting_of(applied.layer, "texture_format");
        if (agreed && *agreed != own) return TextureFormat::keep;
        agreed = own;
    }
    for (const auto& [name, format] : formats)
        if (agreed == name) return format;
    return TextureFormat::keep;
}

/// Warns of layers that fit the model but were made for another file. apply_layers() refuses layers
/// that do not fit.
void warn_of_others(const LayeredModelRequest& request, const Model& model,
                    const std::vector<AppliedLayer>& layers) {
    const std::string hash = hash_of_file(request.model);
    for (const AppliedLayer& applied : layers) {
        const EditLayer& layer = applied.layer;
        const bool fits = misfit(layer, model).empty() && has_same_uvs(layer, model);
        if (layer.model_hash == hash || !fits) continue;
        warn(layer.path.string() + ": was made for another file, " + layer.model +
             "; it is applied because the texture sizes are the same");
    }
}

/// Copies the model's file if it is self-contained and its format stays, else converts it.
void write_unchanged(const LayeredModelRequest& request, const Model& model) {
    const std::string from = to_lower(request.model.extension().string());
    const std::string to = to_lower(request.output.extension().string());
    if (from == to && (from == ".glb" || from == ".vrm")) {
        const Bytes bytes = read_bytes(request.model);
        write_atomically(request.output, std::span<const std::uint8_t>(bytes));
    } else {
        save_model(request.output, model);
    }
}

/// Returns the reason for rebaking layers; empty if they fit.
std::string reason_to_rebake(const LayeredModelRequest& request, const Model& model,
                             const std::vector<AppliedLayer>& layers) {
    if (!request.rebake) return "";
    for (const AppliedLayer& applied : layers) {
        if (applied.use.strength == 0) continue;
        const EditLayer& layer = applied.layer;
        const std::string subject = layer.path.string();
        if (!has_same_uvs(layer, model)) return subject + " is for a model with another UV map";
        const std::string problem = misfit(layer, model);
        if (!problem.empty()) return subject + " " + problem;
    }
    return request.texture_size > 0 ? "another texture size was requested" : "";
}

void rebake_all(const LayeredModelRequest& request, const Model& model, const std::string& reason,
                std::vector<AppliedLayer>& layers) {
    note("layers are baked again from their neural fields: " + reason);
    for (AppliedLayer& applied : layers)
        if (applied.use.strength != 0)
            applied.layer = request.rebake(applied.layer, model, request.texture_size);
}

/// Returns the claims of the layers' edits, in an order that does not depend on the order of the
/// layers.
std::vector<EditClaim> claims_of(const std::vector<AppliedLayer>& layers) {
    std::vector<EditClaim> claims;
    for (const AppliedLayer& applied : layers) {
        if (applied.use.strength == 0 || applied.layer.claim == EditClaim()) continue;
        claims.push_back(applied.layer.claim);
        claims.back().strength = strength_text(applied.use);
    }
    std::sort(claims.begin(), claims.end(), [](const EditClaim& a, const EditClaim& b) {
        return json(a).dump() < json(b).dump();
    });
    return claims;
}

json record_of(const LayeredModelRequest& request, const Model& model,
               const std::vector<AppliedLayer>& layers, const ModelEdit& edit,
               const std::string& rebaked) {
    json record{{"model", request.model.string()},
                {"output", request.output.string()},
                {"layers", json::array()},
                {"materials", json::array()}};
    for (const AppliedLayer& applied : layers) {
        json& layer = record["layers"].emplace_back();
        layer = {{"file", applied.layer.path.string()},
                 {"strength", static_cast<double>(applied.use.strength) / LayerUse::strength_steps},
                 {"from", setting_of(applied.layer, "from")},
                 {"to", setting_of(applied.layer, "to")}};
        if (!rebaked.empty() && applied.use.strength != 0) layer["baked_because"] = rebaked;
    }
    for (const auto& [index, material] : edit.materials)
        record["materials"].push_back(model.materials[static_cast<std::size_t>(index)].name);
    return record;
}

}  // namespace

json write_layered_model(const LayeredModelRequest& request) {
    check_not_replaced(request.model, request.output);
    std::vector<AppliedLayer> layers;
    std::string variant;
    for (const LayerUse& use : request.layers) {
        layers.push_back({load_layer(use.layer), use});
        if (variant.empty()) variant = setting_of(layers.back().layer, "variant");
    }
    Model model =
        load_model(request.model, {.texture_folders = request.texture_folders, .variant = variant});
    const std::string rebaked = reason_to_rebake(request, model, layers);
    if (rebaked.empty())
        warn_of_others(request, model, layers);
    else
        rebake_all(request, model, rebaked, layers);
    ModelEdit edit = apply_layers(layers, model);
    make_folder_of(request.output);
    if (edit.materials.empty()) {
        write_unchanged(request, model);
    } else {
        choose_codings(model, request.texture_format.value_or(format_of(layers)), edit);
        save_model(request.output, model, edit, {claims_of(layers), request.sign_key});
    }
    return record_of(request, model, layers, edit, rebaked);
}

}  // namespace item3d
