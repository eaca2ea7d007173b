#include "item3d/hub/selection.h"

#include "item3d/core/error.h"
#include "item3d/core/parse_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

using Paths = std::vector<std::string>;

bool contains(const Paths& files, const std::string& path) {
    return std::find(files.begin(), files.end(), path) != files.end();
}

/// True for formats whose reading executes code.
bool is_pickle(const std::string& path) {
    for (const char* extension : {".bin", ".ckpt", ".pt", ".pth", ".pkl"})
        if (path.ends_with(extension)) return true;
    return false;
}

/// True for files directly in a part's folder that are neither weights nor their indexes.
bool is_description(const std::string& name) {
    return (name.ends_with(".json") && name.find(".index") == std::string::npos) ||
           name == "merges.txt" || name == "vocab.txt";
}

/// True for the networks that item3d's own priors have beside the diffusion pipeline.
bool is_own_part(const std::string& part) {
    return part == "clip" || part == "captioner" || part == "segmenter";
}

/// Returns the stem of the file name of a part's weights; "" for parts without weights.
std::string weights_stem(const std::string& part) {
    if (part == "unet" || part == "vae") return "diffusion_pytorch_model";
    if (part.starts_with("text_encoder") || is_own_part(part)) return "model";
    return "";
}

constexpr const char* used_parts[] = {
    "scheduler", "text_encoder", "text_encoder_2", "tokenizer", "tokenizer_2",
    "unet",      "vae",          "clip",           "captioner", "segmenter"};

/// True if model_index.json names a class for the part.
bool is_named(const nlohmann::json& index, const std::string& part) {
    const auto entry = index.find(part);
    return entry != index.end() && entry->is_array() && entry->size() == 2 &&
           (*entry)[1].is_string();
}

/// True for a network that one of item3d's priors has beside the diffusion pipeline. Its
/// model_index.json does not name the network, because diffusers would reject the entry.
bool stands_beside(const std::string& part, const Paths& files) {
    return is_own_part(part) && contains(files, "prior.json") &&
           contains(files, part + "/config.json");
}

/// Adds the weights of one variant. Returns false if there are none.
bool add_weights(const std::string& stem, const std::string& variant, const Paths& files,
                 FileSelection& selection) {
    const std::string infix = variant.empty() ? "" : "." + variant;
    if (const std::string single = stem + infix + ".safetensors"; contains(files, single)) {
        selection.files.push_back(single);
        return true;
    }
    for (const std::string& index : {stem + infix + ".safetensors.index.json",
                                     stem + ".safetensors.index" + infix + ".json"}) {
        if (!contains(files, index)) continue;
        selection.indexes.push_back(index);
        return true;
    }
    return false;
}

[[noreturn]] void throw_no_weights(const std::string& repository, const std::string& part,
                                   const Paths& files) {
    for (const std::string& path : files)
        if (path.starts_with(part + "/") && is_pickle(path))
            throw InputError(
                repository,
                fmt::format(
                    "{} has only pickled weights ({}), which can run code when they are loaded",
                    part, path),
                "choose a repository or --revision with safetensors");
    throw InputError(repository, part + " has no safetensors weights",
                     "choose a repository or --revision with safetensors");
}

}  // namespace

void check_layout(const std::string& repository, const Paths& files) {
    if (contains(files, "model_index.json")) return;
    const auto found = std::find_if(files.begin(), files.end(), [](const std::string& path) {
        return is_pickle(path) || path.ends_with(".safetensors");
    });
    if (found == files.end())
        throw InputError(repository, "has no model_index.json and no weights",
                         "choose a text-to-image model in the diffusers layout");
    if (std::none_of(files.begin(), files.end(),
                     [](const std::string& path) { return path.ends_with(".safetensors"); }))
        throw InputError(
            repository,
            fmt::format("has only pickled weights ({}), which can run code when they are loaded",
                        *found),
            "choose a repository in the diffusers layout with safetensors");
    throw InputError(
        repository,
        fmt::format("has {} but no model_index.json, so it is not in the diffusers layout", *found),
        "choose a repository with the same model in the diffusers layout");
}

FileSelection select_files(const std::string& repository, const std::string& model_index,
                           const Paths& files, const std::string& variant) {
    const nlohmann::json index = parse_json(model_index);
    if (!index.is_object())
        throw InputError(repository + "/model_index.json", "is not a JSON object",
                         "choose another repository or revision");

    FileSelection selection;
    selection.files.push_back("model_index.json");
    if (contains(files, "prior.json")) selection.files.push_back("prior.json");
    bool has_network = false, has_variant = false;
    for (const std::string part : used_parts) {
        if (!is_named(index, part) && !stands_beside(part, files)) continue;
        for (const std::string& path : files)
            if (path.starts_with(part + "/") && is_description(path.substr(part.size() + 1)) &&
                path.find('/', part.size() + 1) == std::string::npos)
                selection.files.push_back(path);
        const std::string stem = weights_stem(part);
        if (stem.empty()) continue;
        has_network = true;
        const std::string path = part + "/" + stem;
        const std::string other = variant.empty() ? "fp16" : "";
        if (add_weights(path, variant, files, selection))
            has_variant = true;
        else if (!add_weights(path, other, files, selection))
            throw_no_weights(repository, part, files);
    }
    if (!has_network)
        throw InputError(repository + "/model_index.json", "lists no part that item3d knows",
                         "choose a Stable Diffusion model in the diffusers layout");
    if (!variant.empty() && !has_variant)
        throw InputError(repository, "has no " + variant + " variant", "leave out --variant");
    return selection;
}

Paths shards_of_index(const std::string& repository, const std::string& index,
                      const std::string& text, const Paths& files) {
    const std::string subject = repository + "/" + index;
    const nlohmann::json json = parse_json(text);
    if (!json.is_object() || !json.contains("weight_map") || !json["weight_map"].is_object())
        throw InputError(subject, "expected a weight_map of tensors and files",
                         "download the index again");
    const std::string folder = index.substr(0, index.rfind('/') + 1);
    std::set<std::string> shards;
    for (const auto& [tensor, file] : json["weight_map"].items()) {
        const std::string name = file.is_string() ? file.get<std::string>() : "";
        if (name.empty() || name.find_first_of("/\\") != std::string::npos || name == "..")
            throw InputError(subject, fmt::format("'{}' is not a file next to the index", name),
                             "download the index again");
        if (!contains(files, folder + name))
            throw InputError(
                subject,
                fmt::format("lists the shard {}, which is missing in the repository", name),
                "choose another repository or --revision");
        if (!name.ends_with(".safetensors"))
            throw InputError(subject, fmt::format("'{}' is not a safetensors file", name),
                             "choose weights in this format");
        shards.insert(folder + name);
    }
    return {shards.begin(), shards.end()};
}

}  // namespace item3d
