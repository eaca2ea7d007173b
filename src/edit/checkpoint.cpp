#include "item3d/edit/checkpoint.h"

#include "item3d/core/error.h"

namespace item3d {

void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
    save_safetensors(
        path, checkpoint.tensors,
        {{"identity", checkpoint.identity}, {"iteration", std::to_string(checkpoint.iteration)}});
}

std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) return std::nullopt;
    const SafeTensors file = SafeTensors::open(path);
    const auto identity = file.metadata().find("identity");
    const auto iteration = file.metadata().find("iteration");
    if (identity == file.metadata().end() || iteration == file.metadata().end()) {
        throw InputError(path.string(), "is not a checkpoint of an edit",
                         "remove it, or leave out --resume");
    }
    Checkpoint checkpoint;
    checkpoint.identity = identity->second;
    checkpoint.iteration = std::strtoll(iteration->second.c_str(), nullptr, 10);
    for (const auto& [name, tensor] : file.tensors()) {
        checkpoint.tensors.emplace_back(name, tensor.clone());
    }
    return checkpoint;
}

}  // namespace item3d
