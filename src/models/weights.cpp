#include "item3d/models/weights.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/models/config.h"

#include <set>

namespace item3d {
namespace {

std::string shape_text(const torch::Tensor& tensor) {
    return fmt::format("[{}]", fmt::join(tensor.sizes().vec(), ", "));
}

std::vector<std::filesystem::path> shards_of(const std::filesystem::path& index) {
    const Config config = Config::read(index);
    if (!config.has("weight_map") || !config.json()["weight_map"].is_object())
        config.fail("weight_map", "an object of tensor and file names");
    std::set<std::string> names;
    for (const auto& [tensor, file] : config.json()["weight_map"].items()) {
        if (!file.is_string()) config.fail("weight_map", "an object of tensor and file names");
        const std::filesystem::path name = file.get<std::string>();
        if (name.empty() || name.filename() != name)
            config.reject("weight_map", "'" + name.string() + "' is not a file beside the index");
        names.insert(name.string());
    }
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names)
        files.push_back(index.parent_path() / name);
    return files;
}

}  // namespace

Weights Weights::open_file(const std::filesystem::path& file) {
    Weights weights;
    weights.subject_ = file.string();
    weights.add(SafeTensors::open(file));
    return weights;
}

Weights Weights::open(const std::filesystem::path& folder, const std::string& stem) {
    for (const char* variant : {"", ".fp16"}) {
        const auto single = folder / (stem + variant + ".safetensors");
        if (std::filesystem::exists(single)) return open_file(single);
        for (const auto& name : {stem + variant + ".safetensors.index.json",
                                 stem + ".safetensors.index" + variant + ".json"}) {
            const auto index = folder / name;
            if (!std::filesystem::exists(index)) continue;
            Weights weights;
            weights.subject_ = index.string();
            for (const auto& shard : shards_of(index))
                weights.add(SafeTensors::open(shard));
            return weights;
        }
    }
    throw InputError((folder / (stem + ".safetensors")).string(),
                     "no weights are here (a file, an index of shards, or an fp16 variant)",
                     "download or convert them to safetensors");
}

void Weights::add(SafeTensors file) {
    for (const std::string& name : file.names())
        if (!places_.emplace(name, Place{files_.size(), name}).second)
            throw InputError(file.path().string(),
                             fmt::format("tensor '{}' is in another shard too", name));
    files_.push_back(std::move(file));
}

void Weights::rename(const std::function<std::string(const std::string&)>& new_name) {
    std::map<std::string, Place> renamed;
    for (auto& [name, place] : places_) {
        const std::string wanted = new_name(name);
        if (wanted.empty()) continue;
        if (!renamed.emplace(wanted, place).second)
            throw InputError(file_of(name), fmt::format("two tensors mean '{}'", wanted));
    }
    places_ = std::move(renamed);
}

std::vector<std::string> Weights::names() const {
    std::vector<std::string> result;
    for (const auto& [name, place] : places_)
        result.push_back(name);
    return result;
}

torch::Tensor Weights::tensor(const std::string& name) const {
    const auto found = places_.find(name);
    if (found == places_.end())
        throw InputError(subject_, fmt::format("tensor '{}' is missing", name));
    return files_[found->second.file].tensor(found->second.name);
}

std::string Weights::file_of(const std::string& name) const {
    const auto found = places_.find(name);
    return found == places_.end() ? subject_ : files_[found->second.file].path().string();
}

std::int64_t Weights::total_elements() const {
    std::int64_t total = 0;
    for (const SafeTensors& file : files_)
        total += file.total_elements();
    return total;
}

void load_parameters(torch::nn::Module& module, const Weights& weights, torch::Device device,
                     torch::Dtype dtype) {
    const torch::NoGradGuard no_grad;
    std::set<std::string> used;
    const auto load = [&](const std::string& name, torch::Tensor& target) {
        if (!weights.contains(name))
            throw InputError(
                weights.subject(),
                fmt::format("tensor '{}' of shape {} is missing", name, shape_text(target)),
                "the weights do not belong to this config.json");
        const torch::Tensor source = weights.tensor(name);
        if (source.sizes() != target.sizes())
            throw InputError(weights.file_of(name),
                             fmt::format("tensor '{}': expected shape {}, found {}", name,
                                         shape_text(target), shape_text(source)),
                             "the weights do not belong to this config.json");
        if (!source.is_floating_point())
            throw InputError(weights.file_of(name),
                             fmt::format("tensor '{}' is not of floating point", name));
        target.set_data(source.to(device, dtype));
        used.insert(name);
    };
    for (auto& parameter : module.named_parameters()) {
        load(parameter.key(), parameter.value());
        parameter.value().set_requires_grad(false);
    }
    for (auto& buffer : module.named_buffers())
        load(buffer.key(), buffer.value());
    for (const std::string& name : weights.names())
        if (used.count(name) == 0)
            throw InputError(weights.file_of(name),
                             fmt::format("tensor '{}' has no place in the network", name),
                             "the weights do not belong to this config.json");
}

NamedTensors module_tensors(const torch::nn::Module& module, torch::Dtype dtype,
                            const std::string& prefix) {
    NamedTensors result;
    for (const auto& parameter : module.named_parameters())
        result.emplace_back(prefix + parameter.key(), parameter.value().detach().to(dtype));
    for (const auto& buffer : module.named_buffers())
        result.emplace_back(prefix + buffer.key(), buffer.value().detach().to(dtype));
    return result;
}

void check_plausible(const Weights& weights, double elements) {
    if (elements > static_cast<double>(weights.total_elements()))
        throw InputError(
            weights.subject(),
            fmt::format("holds {} numbers, but config.json describes a network of more "
                        "than {:.0f}",
                        weights.total_elements(), elements),
            "the weights do not belong to this config.json");
}

}  // namespace item3d
