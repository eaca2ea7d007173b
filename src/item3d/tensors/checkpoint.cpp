#include "item3d/tensors/checkpoint.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/random.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>
#include <system_error>

namespace item3d {

namespace {

constexpr const char* begin_anew = "leave out --resume to start from the beginning";
constexpr std::int64_t large = 65536;  ///< number of rows from which a tensor is large
/// Limits of a tensor that is stored by rows, so that a damaged file cannot exhaust the memory.
/// Hash grids are far smaller.
constexpr std::int64_t max_rows = std::int64_t{1} << 32;
constexpr double max_elements = 4e8;  // FlexiCubes weights of 256^3 cells have 3.5e8
/// Name suffixes of the three tensors that store one tensor by rows: the tensor's number of rows,
/// the indices of the stored rows, and the values of the stored rows.
const std::string all_rows = "#all", row_places = "#rows", row_values = "#values";

/// Appends the tensor, or its nonzero rows.
void append_rows(NamedTensors& tensors, const std::string& name, const at::Tensor& tensor) {
    if (tensor.dim() > 0 && tensor.size(0) >= large) {
        const at::Tensor used =
            tensor.reshape({tensor.size(0), -1}).ne(0).any(1).nonzero().select(1, 0);
        if (2 * used.size(0) < tensor.size(0)) {
            tensors.emplace_back(name + all_rows, at::tensor({tensor.size(0)}));
            tensors.emplace_back(name + row_places, used);
            tensors.emplace_back(name + row_values, tensor.index_select(0, used));
            return;
        }
    }
    tensors.emplace_back(name, tensor);
}

/// Returns zeros whose pages use no memory before they are touched. A tensor of a damaged file is
/// large, but its shape is refused before it is read.
at::Tensor zeros_on_demand(at::IntArrayRef shape, const at::TensorOptions& options) {
    constexpr std::size_t alignment = 64;
    const auto elements = static_cast<std::size_t>(c10::multiply_integers(shape));
    const std::size_t bytes = elements * options.dtype().itemsize();
    std::size_t space = bytes + alignment;
    const std::shared_ptr<void> memory(std::calloc(space, 1), &std::free);
    if (!memory) throw std::bad_alloc();
    void* aligned = memory.get();
    ITEM3D_CHECK(std::align(alignment, bytes, aligned, space), "calloc() returned too little");
    return at::from_blob(
        aligned, shape, [memory](void*) {}, options);  // the tensor keeps the memory alive
}

/// Returns the whole tensor, of which append_rows() stored some rows. The other rows are 0.
at::Tensor with_zero_rows(const SafeTensors& file, const std::string& name) {
    const at::Tensor count = file.tensor(name + all_rows), places = file.tensor(name + row_places);
    const at::Tensor values = file.tensor(name + row_values);
    const bool is_whole = count.scalar_type() == at::kLong && count.numel() == 1 &&
                          places.scalar_type() == at::kLong && places.dim() == 1 &&
                          values.dim() > 0 && values.size(0) == places.size(0);
    const std::int64_t rows = is_whole ? count.item<std::int64_t>() : -1;
    if (rows < places.numel() || rows > max_rows ||
        (places.numel() > 0 &&
         (places.min().item<std::int64_t>() < 0 || places.max().item<std::int64_t>() >= rows)))
        throw InputError(file.path().string(), "the rows of tensor '" + name + "' do not fit");
    std::vector<std::int64_t> shape = values.sizes().vec();
    shape.front() = rows;
    double elements = 1;
    for (const std::int64_t extent : shape)
        elements *= static_cast<double>(std::max<std::int64_t>(extent, 1));
    if (elements > max_elements)
        throw InputError(file.path().string(), "tensor '" + name + "' is too large");
    return zeros_on_demand(shape, values.options()).index_copy_(0, places, values);
}

/// Returns all tensors of the file. Those that append_rows() stored by rows are whole again.
NamedTensors whole_tensors(const SafeTensors& file) {
    NamedTensors tensors;
    for (const std::string& name : file.names()) {
        if (name.ends_with(row_places) || name.ends_with(row_values)) continue;
        if (!name.ends_with(all_rows)) {
            tensors.emplace_back(name, file.tensor(name).clone());
            continue;
        }
        const std::string own = name.substr(0, name.size() - all_rows.size());
        tensors.emplace_back(own, with_zero_rows(file, own));
    }
    return tensors;
}

}  // namespace

void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
    NamedTensors tensors;
    for (const auto& [name, tensor] : checkpoint.tensors)
        append_rows(tensors, name, tensor);
    save_safetensors(path, tensors,
                     {{"identity", checkpoint.identity.dump()},
                      {"iteration", std::to_string(checkpoint.iteration)}});
}

std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) return std::nullopt;
    const SafeTensors file = [&path] {
        try {
            return SafeTensors::open(path);
        } catch (const InputError&) {
            throw InputError(path.string(), "is damaged, or not a checkpoint",
                             "delete it, or leave out --resume");
        }
    }();
    const auto identity = file.metadata().find("identity");
    const auto iteration = file.metadata().find("iteration");
    if (identity == file.metadata().end() || iteration == file.metadata().end()) {
        throw InputError(path.string(), "is not a checkpoint of item3d",
                         "delete it, or leave out --resume");
    }
    Checkpoint checkpoint;
    checkpoint.identity = parse_json(identity->second);
    checkpoint.iteration = std::strtoll(iteration->second.c_str(), nullptr, 10);
    try {
        checkpoint.tensors = whole_tensors(file);
    } catch (const InputError& error) {
        throw InputError(path.string(), "is damaged", "delete it, or leave out --resume");
    }
    return checkpoint;
}

std::string hash_of_file(const std::filesystem::path& path) {
    std::uint64_t hash = 0;
    for (const std::uint8_t byte : read_bytes(path))
        hash = mix_bits(hash ^ byte);
    return fmt::format("{:016x}", hash);
}

std::string hash_of_weights(const std::filesystem::path& prior) {
    std::vector<std::filesystem::path> files;
    for (const char* part : {"unet", "text_encoder", "text_encoder_2", "vae"}) {
        std::error_code ignored;  // loading reports a missing part
        for (const auto& entry : std::filesystem::directory_iterator(prior / part, ignored))
            if (entry.path().extension() == ".safetensors") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::uint64_t hash = 0;
    std::vector<std::uint64_t> words(1 << 17);
    for (const auto& file : files) {
        std::ifstream stream(file, std::ios::binary);
        while (stream) {
            std::fill(words.begin(), words.end(), 0);
            stream.read(reinterpret_cast<char*>(words.data()),
                        static_cast<std::streamsize>(words.size() * sizeof(words[0])));
            const auto read = static_cast<std::size_t>(stream.gcount());
            for (std::size_t i = 0; i * sizeof(words[0]) < read; ++i)
                hash = mix_bits(hash ^ words[i]);
        }
    }
    return fmt::format("{:016x}", hash);
}

void require_same_identity(const std::filesystem::path& path, const nlohmann::json& saved,
                           const nlohmann::json& now,
                           const std::map<std::string, std::string>& inputs) {
    const auto reject = [&](const std::string& problem) {
        throw InputError(path.string(), problem,
                         "use the same command, or leave out --resume to start from the beginning");
    };
    const auto before = [&](const std::string& key) {
        return saved.is_object() ? saved.value(key, nlohmann::json()) : nlohmann::json();
    };
    // Compares the inputs first, because settings depend on them. For example, a command without
    // --mesh also has other settings.
    for (const auto& [key, problem] : inputs)
        if (now.contains(key) && before(key) != now[key]) reject(problem);
    for (const auto& [key, value] : now.items())
        if (before(key) != value)
            reject(fmt::format("was made with {} = {}, but this command has {}", key,
                               before(key).dump(), value.dump()));
}

void append_parameters(NamedTensors& tensors, const std::string& prefix,
                       const NamedTensors& parameters) {
    for (const auto& [name, parameter] : parameters)
        tensors.emplace_back(prefix + name, parameter.detach());
}

CheckpointReader::CheckpointReader(std::string subject, const NamedTensors& tensors)
    : subject_(std::move(subject)) {
    for (const auto& [name, tensor] : tensors)
        tensors_[name] = tensor;
}

at::Tensor CheckpointReader::get(const std::string& name) const {
    const auto found = tensors_.find(name);
    if (found == tensors_.end()) throw InputError(subject_, "has no tensor " + name, begin_anew);
    return found->second;
}

void CheckpointReader::copy(const std::string& name, at::Tensor target) const {
    const at::NoGradGuard no_grad;
    const at::Tensor saved = get(name);
    if (saved.sizes() != target.sizes())
        throw InputError(subject_, "tensor " + name + " has another shape", begin_anew);
    target.copy_(saved);
}

void CheckpointReader::parameters(const std::string& prefix, const NamedTensors& parameters) const {
    for (const auto& [name, parameter] : parameters)
        copy(prefix + name, parameter);
}

std::map<std::string, at::Tensor> CheckpointReader::with_prefix(const std::string& prefix) const {
    std::map<std::string, at::Tensor> found;
    for (const auto& [name, tensor] : tensors_) {
        if (name.starts_with(prefix)) found[name.substr(prefix.size())] = tensor;
    }
    return found;
}

}  // namespace item3d
