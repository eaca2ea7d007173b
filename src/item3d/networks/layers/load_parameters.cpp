#include "item3d/networks/layers/load_parameters.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/kernels/cpu/linear/weight_kernel.h"
#include "item3d/networks/layers/conv3x3.h"
#include "item3d/networks/layers/packable_linear.h"
#include "item3d/tensors/parallel_ranges.h"
#include "item3d/tensors/weight_memory.h"

#include <map>
#include <memory>

namespace item3d {
namespace {

std::string shape_text(c10::IntArrayRef shape) {
    return fmt::format("[{}]", fmt::join(shape.vec(), ", "));
}

/// Collects mismatches of tensors. Throws a single error that names the first mismatch and the
/// number of mismatches.
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
        throw InputError(file_, problem_ + more, "use the weights of this config.json");
    }

  private:
    int count_ = 0;
    std::string file_;
    std::string problem_;
};

using Places = std::map<std::string, at::Tensor*>;

/// Throws InputError unless `weights` contains exactly the tensors of `places`, with the same
/// shapes.
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
                        fmt::format("tensor '{}' is not a floating-point tensor", name));
    }
    for (const std::string& name : weights.names())
        if (places.count(name) == 0)
            misfits.add(weights.file_of(name), fmt::format("tensor '{}' is unexpected", name));
    misfits.throw_if_any();
}

/// Gives the file's weights to the 3x3 convolutions, which pack them on first use. Removes these
/// weights from `places`.
void leave_in_file(torch::nn::Module& module, const Weights& weights, Places& places) {
    const auto shared = std::make_shared<const Weights>(weights);
    for (const auto& layer : module.named_modules()) {
        auto* convolution = layer.value()->as<Conv3x3>();
        const std::string name = layer.key() + ".weight";
        if (!convolution || places.erase(name) == 0) continue;
        convolution->map_weights(weights.tensor(name),
                                 [shared, name] { shared->release_pages(name); });
    }
}

/// Makes linear layers that run in float32 keep the file's float16 weights, and removes them from
/// `places`.
void pack_fp16(torch::nn::Module& module, const Weights& weights, Places& places) {
    for (const auto& layer : module.named_modules()) {
        auto* linear = dynamic_cast<PackableLinearImpl*>(layer.value().get());
        const std::string name = layer.key() + ".weight";
        if (!linear || places.count(name) == 0 || !linear->pack_stored(weights.tensor(name)))
            continue;
        places.erase(name);
        weights.release_pages(name);
    }
}

/// True if a weight is copied to its own memory. This does not apply to convolutions, whose weights
/// are reordered later and in part released.
bool is_converted(at::ScalarType stored, std::int64_t dimensions, at::Device device,
                  at::ScalarType dtype) {
    return device.is_cpu() && stored != dtype && dimensions != 4;
}

std::size_t converted_bytes(const Places& places, const Weights& weights, at::Device device,
                            at::ScalarType dtype) {
    std::size_t bytes = 0;
    for (const auto& place : places) {
        const TensorInfo info = weights.info(place.first);
        if (is_converted(info.dtype, static_cast<std::int64_t>(info.shape.size()), device, dtype))
            bytes += WeightMemory::room_for(info.shape, dtype);
    }
    return bytes;
}

/// Converts contiguous numbers to another type.
void convert(const at::Tensor& from, const at::Tensor& to) {
    const auto& kernel = kernel_for_this_processor<BFloat16>(
        []<InstructionSet instructions> { return weight_kernel<instructions, BFloat16>(); });
    if (!kernel || from.scalar_type() != at::kHalf || to.scalar_type() != at::kBFloat16) {
        to.copy_(from);
        return;
    }
    constexpr std::int64_t fewest = 1 << 16;  // per thread
    parallel_ranges(from.numel(), fewest, [&](std::int64_t first, std::int64_t last) {
        kernel->convert_halves(static_cast<const Float16*>(from.data_ptr()) + first, last - first,
                               static_cast<BFloat16*>(to.data_ptr()) + first);
    });
}

}  // namespace

void load_parameters(torch::nn::Module& module, const Weights& weights, at::Device device,
                     at::ScalarType dtype, WeightUse use) {
    const at::NoGradGuard no_grad;
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
        if (dtype == at::kFloat) pack_fp16(module, weights, places);
    }
    WeightMemory memory(converted_bytes(places, weights, device, dtype));
    for (const auto& [name, target] : places) {
        const at::Tensor stored = weights.tensor(name);
        const bool converted = is_converted(stored.scalar_type(), stored.dim(), device, dtype);
        const at::Tensor value =
            converted ? memory.empty(stored.sizes(), dtype) : stored.to(device, dtype);
        if (converted) convert(stored, value);
        target->set_data(value);
        // The pages are released, because a converted network would otherwise be in memory twice at
        // the end of loading.
        if (!value.is_alias_of(stored)) weights.release_pages(name);
    }
}

NamedTensors module_tensors(const torch::nn::Module& module, at::ScalarType dtype,
                            const std::string& prefix) {
    NamedTensors result;
    for (const auto& parameter : module.named_parameters())
        result.emplace_back(prefix + parameter.key(), parameter.value().detach().to(dtype));
    for (const auto& buffer : module.named_buffers())
        result.emplace_back(prefix + buffer.key(), buffer.value().detach().to(dtype));
    return result;
}

}  // namespace item3d
