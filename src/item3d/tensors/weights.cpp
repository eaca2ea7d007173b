#include "item3d/tensors/weights.h"

#include "item3d/core/config.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/kernels/cpu/linear/weight_kernel.h"
#include "item3d/networks/layers/conv3x3.h"
#include "item3d/networks/layers/packable_linear.h"
#include "item3d/tensors/weight_memory.h"

#include <ATen/Parallel.h>

#include <memory>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string shape_text(c10::IntArrayRef shape) {
    return fmt::format("[{}]", fmt::join(shape.vec(), ", "));
}

/// Shard of each tensor, as an index tells it.
std::map<std::string, std::string> read_index(const fs::path& index) {
    const Config config = Config::read(index);
    if (!config.has("weight_map") || !config.json()["weight_map"].is_object())
        config.fail("weight_map", "an object of tensor and file names");
    std::map<std::string, std::string> shards;
    for (const auto& [tensor, file] : config.json()["weight_map"].items()) {
        if (!file.is_string()) config.fail("weight_map", "an object of tensor and file names");
        const fs::path name = file.get<std::string>();
        if (name.empty() || name.filename() != name || name == ".." || name == ".")
            config.reject("weight_map", "'" + name.string() + "' is not a file beside the index");
        shards[tensor] = name.string();
    }
    return shards;
}

/// True when the file is there. Throws when it is a link that leads nowhere, as caches leave them.
bool is_there(const fs::path& path) {
    if (fs::exists(path)) return true;
    if (fs::is_symlink(path))
        throw InputError(path.string(), "links to a file that is not there",
                         "fetch it again (item3d prior pull)");
    return false;
}

/// The file of `folder` that holds weights as pickles; "" when none does.
std::string find_pickle(const fs::path& folder) {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder, code))
        for (const char* extension : {".bin", ".ckpt", ".pt", ".pth"})
            if (entry.path().extension() == extension) return entry.path().string();
    return "";
}

/// What keeps tensors from their places. All are looked at before the first is told.
class Misfits {
  public:
    void add(const std::string& file, const std::string& problem) {
        if (count_++ > 0) return;
        file_ = file;
        problem_ = problem;
    }
    void throw_if_any() const {
        if (count_ == 0) return;
        const std::string more =
            count_ == 1 ? "" : fmt::format(" (and {} more tensors do not fit)", count_ - 1);
        throw InputError(file_, problem_ + more, "the weights do not belong to this config.json");
    }

  private:
    int count_ = 0;
    std::string file_;
    std::string problem_;
};

using Places = std::map<std::string, torch::Tensor*>;

/// Throws unless the tensors of `weights` are those of `places`.
void compare(const Places& places, const Weights& weights) {
    Misfits misfits;
    for (const auto& [name, target] : places) {
        if (!weights.contains(name)) {
            misfits.add(weights.subject(), fmt::format("tensor '{}' of shape {} is missing", name,
                                                       shape_text(target->sizes())));
            continue;
        }
        const TensorInfo found = weights.info(name);
        if (found.shape != target->sizes())
            misfits.add(weights.file_of(name),
                        fmt::format("tensor '{}': expected shape {}, found {}", name,
                                    shape_text(target->sizes()), shape_text(found.shape)));
        else if (!c10::isFloatingType(found.dtype))
            misfits.add(weights.file_of(name),
                        fmt::format("tensor '{}' is not of floating point", name));
    }
    for (const std::string& name : weights.names())
        if (places.count(name) == 0)
            misfits.add(weights.file_of(name),
                        fmt::format("tensor '{}' has no place in the network", name));
    misfits.throw_if_any();
}

/// Gives the convolutions that pack their weights those of the file, and takes them out of
/// `places`.
void leave_in_file(torch::nn::Module& module, const Weights& weights, Places& places) {
    const auto shared = std::make_shared<const Weights>(weights);
    for (const auto& layer : module.named_modules()) {
        auto* convolution = layer.value()->as<Conv3x3>();
        const std::string name = layer.key() + ".weight";
        if (!convolution || places.erase(name) == 0) continue;
        convolution->run_from(weights.tensor(name), [shared, name] { shared->forget(name); });
    }
}

/// Linear layers that will run in float32 keep the numbers that the file has, and are taken out of
/// `places`.
void keep_halves(torch::nn::Module& module, const Weights& weights, Places& places) {
    for (const auto& layer : module.named_modules()) {
        auto* linear = dynamic_cast<PackableLinearImpl*>(layer.value().get());
        const std::string name = layer.key() + ".weight";
        if (!linear || places.count(name) == 0 || !linear->pack_stored(weights.tensor(name)))
            continue;
        places.erase(name);
        weights.forget(name);
    }
}

/// Whether a weight goes into memory of its own: not those of convolutions, which are put in
/// another order after this and some of which are given up.
bool is_converted(torch::Dtype stored, std::int64_t dimensions, torch::Device device,
                  torch::Dtype dtype) {
    return device.is_cpu() && stored != dtype && dimensions != 4;
}

std::size_t converted_bytes(const Places& places, const Weights& weights, torch::Device device,
                            torch::Dtype dtype) {
    std::size_t bytes = 0;
    for (const auto& place : places) {
        const TensorInfo info = weights.info(place.first);
        if (is_converted(info.dtype, static_cast<std::int64_t>(info.shape.size()), device, dtype))
            bytes += WeightMemory::room_for(info.shape, dtype);
    }
    return bytes;
}

/// from, contiguous, as numbers of another type.
void convert(const torch::Tensor& from, const torch::Tensor& to) {
    const auto& kernel = kernel_for_this_processor<BrainFloat>(
        []<Instructions instructions> { return weight_kernel<instructions, BrainFloat>(); });
    if (!kernel || from.scalar_type() != torch::kFloat16 || to.scalar_type() != torch::kBFloat16) {
        to.copy_(from);
        return;
    }
    constexpr std::int64_t fewest = 1 << 16;  // for a thread
    at::parallel_for(0, from.numel(), fewest, [&](std::int64_t first, std::int64_t last) {
        kernel->convert_halves(static_cast<const HalfFloat*>(from.data_ptr()) + first, last - first,
                               static_cast<BrainFloat*>(to.data_ptr()) + first);
    });
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
                             fmt::format("names the shard {}, which is not there", shard),
                             "fetch the weights again");
        weights.add(SafeTensors::open(path));
    }
    for (const auto& [tensor, shard] : shard_of)
        if (!weights.contains(tensor) ||
            weights.files_[weights.place(tensor).file].path().filename() != shard)
            throw InputError(
                (index.parent_path() / shard).string(),
                fmt::format("tensor '{}', which the index promises, is missing", tensor),
                "fetch the weights again");
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
        throw InputError(pickle, "is a pickle, which runs code when it is read; it is not",
                         "download or convert the weights to safetensors");
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

const Weights::Place& Weights::place(const std::string& name) const {
    const auto found = places_.find(name);
    if (found == places_.end())
        throw InputError(subject_, fmt::format("tensor '{}' is missing", name));
    return found->second;
}

torch::Tensor Weights::tensor(const std::string& name) const {
    return files_[place(name).file].tensor(place(name).name);
}

TensorInfo Weights::info(const std::string& name) const {
    return files_[place(name).file].info(place(name).name);
}

void Weights::forget(const std::string& name) const {
    files_[place(name).file].forget(place(name).name);
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
                     torch::Dtype dtype, WeightUse use) {
    const torch::NoGradGuard no_grad;
    Places places;
    auto parameters = module.named_parameters();
    auto buffers = module.named_buffers();
    for (auto& parameter : parameters) {
        parameter.value().set_requires_grad(false);
        places[parameter.key()] = &parameter.value();
    }
    for (auto& buffer : buffers)
        places[buffer.key()] = &buffer.value();
    compare(places, weights);
    if (device.is_meta()) return;
    if (use == WeightUse::running && device.is_cpu()) {
        leave_in_file(module, weights, places);
        if (dtype == torch::kFloat32) keep_halves(module, weights, places);
    }
    WeightMemory memory(converted_bytes(places, weights, device, dtype));
    for (const auto& [name, target] : places) {
        const torch::Tensor stored = weights.tensor(name);
        const bool converted = is_converted(stored.scalar_type(), stored.dim(), device, dtype);
        const torch::Tensor value =
            converted ? memory.empty(stored.sizes(), dtype) : stored.to(device, dtype);
        if (converted) convert(stored, value);
        target->set_data(value);
        // Else a converted network would be in memory twice at the end of loading.
        if (!value.is_alias_of(stored)) weights.forget(name);
    }
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
