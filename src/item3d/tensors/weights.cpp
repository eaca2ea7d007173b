#include "item3d/tensors/weights.h"

#include "item3d/core/config.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns the shard of each tensor, as the index says.
std::map<std::string, std::string> read_index(const fs::path& index) {
    const Config config = Config::read(index);
    if (!config.has("weight_map") || !config.json()["weight_map"].is_object())
        config.fail("weight_map", "an object of tensor and file names");
    std::map<std::string, std::string> shards;
    for (const auto& [tensor, file] : config.json()["weight_map"].items()) {
        if (!file.is_string()) config.fail("weight_map", "an object of tensor and file names");
        const fs::path name = file.get<std::string>();
        if (name.empty() || name.filename() != name || name == ".." || name == ".")
            config.reject("weight_map", "'" + name.string() + "' is not a file next to the index");
        shards[tensor] = name.string();
    }
    return shards;
}

/// True if the file exists. Throws InputError for a dangling link, as in an incomplete cache.
bool is_there(const fs::path& path) {
    if (fs::exists(path)) return true;
    if (fs::is_symlink(path))
        throw InputError(path.string(), "links to a file that does not exist",
                         "download it again (item3d prior pull)");
    return false;
}

/// Returns the file in `folder` that holds weights as pickles; "" for none.
std::string find_pickle(const fs::path& folder) {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder, code))
        for (const char* extension : {".bin", ".ckpt", ".pt", ".pth"})
            if (entry.path().extension() == extension) return entry.path().string();
    return "";
}

}  // namespace

Weights Weights::open_file(const std::filesystem::path& file) {
    Weights weights;
    weights.subject_ = file.string();
    weights.add(SafeTensors::open(file));
    return weights;
}

Weights Weights::open_index(const fs::path& index) {
    Weights weights;
    weights.subject_ = index.string();
    const auto shard_of = read_index(index);
    std::set<std::string> shards;
    for (const auto& [tensor, shard] : shard_of)
        shards.insert(shard);
    for (const std::string& shard : shards) {
        const fs::path path = index.parent_path() / shard;
        if (!is_there(path))
            throw InputError(index.string(),
                             fmt::format("lists the shard {}, which does not exist", shard),
                             "download the weights again");
        weights.add(SafeTensors::open(path));
    }
    for (const auto& [tensor, shard] : shard_of)
        if (!weights.contains(tensor) ||
            weights.files_[weights.place(tensor).file].path().filename() != shard)
            throw InputError((index.parent_path() / shard).string(),
                             fmt::format("tensor '{}', which the index lists, is missing", tensor),
                             "download the weights again");
    return weights;
}

Weights Weights::open(const fs::path& folder, const std::string& stem) {
    for (const char* variant : {"", ".fp16"}) {
        const auto single = folder / (stem + variant + ".safetensors");
        if (is_there(single)) return open_file(single);
        for (const auto& name : {stem + variant + ".safetensors.index.json",
                                 stem + ".safetensors.index" + variant + ".json"})
            if (is_there(folder / name)) return open_index(folder / name);
    }
    if (const std::string pickle = find_pickle(folder); !pickle.empty())
        throw InputError(pickle,
                         "is a pickle, which can run code when it is loaded, and is not read",
                         "download or convert the weights to safetensors");
    throw InputError((folder / (stem + ".safetensors")).string(),
                     "contains no weights (a file, an index of shards, or an fp16 variant)",
                     "download or convert them to safetensors");
}

void Weights::add(SafeTensors file) {
    for (const std::string& name : file.names())
        if (!places_.emplace(name, Place{files_.size(), name}).second)
            throw InputError(file.path().string(),
                             fmt::format("tensor '{}' is also in another file of the model", name),
                             "get the folder again");
    files_.push_back(std::move(file));
}

void Weights::rename(const std::function<std::string(const std::string&)>& new_name) {
    std::map<std::string, Place> renamed;
    for (auto& [name, place] : places_) {
        const std::string wanted = new_name(name);
        if (wanted.empty()) continue;
        if (!renamed.emplace(wanted, place).second)
            throw InputError(file_of(name), fmt::format("two tensors are for '{}'", wanted),
                             "download the weights again");
    }
    places_ = std::move(renamed);
}

std::vector<std::string> Weights::names() const {
    std::vector<std::string> result;
    for (const auto& [name, place] : places_)
        result.push_back(name);
    return result;
}

const Weights::Place& Weights::place(const std::string& name) const {
    const auto found = places_.find(name);
    if (found == places_.end())
        throw InputError(subject_, fmt::format("tensor '{}' is missing", name),
                         "choose weights that fit the configuration");
    return found->second;
}

at::Tensor Weights::tensor(const std::string& name) const {
    return files_[place(name).file].tensor(place(name).name);
}

TensorInfo Weights::info(const std::string& name) const {
    return files_[place(name).file].info(place(name).name);
}

void Weights::release_pages(const std::string& name) const {
    files_[place(name).file].release_pages(place(name).name);
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

void check_plausible(const Weights& weights, double elements) {
    if (elements > static_cast<double>(weights.total_elements()))
        throw InputError(
            weights.subject(),
            fmt::format(
                "contains {} numbers, but config.json describes a network of more than {:.0f}",
                weights.total_elements(), elements),
            "use the weights of this config.json");
}

}  // namespace item3d
