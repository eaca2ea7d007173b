#include "python/src/operation.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace item3d {

int thread_count() {
    return static_cast<int>(torch::stable::get_num_threads());
}

void run_on_threads(std::int64_t blocks, const void* f,
                    void (*run)(const void* f, std::int64_t block)) {
    const std::int64_t threads = std::min<std::int64_t>(blocks, thread_count());
    if (threads <= 1) {
        for (std::int64_t block = 0; block < blocks; ++block)
            run(f, block);
        return;
    }
    // Blocks take different times, so each thread takes the next block when it has finished one.
    std::atomic<std::int64_t> next{0};
    torch::stable::parallel_for(0, threads, 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t thread = begin; thread < end; ++thread)
            for (std::int64_t block = next++; block < blocks; block = next++)
                run(f, block);
    });
}

namespace python {
namespace {

using torch::stable::Device;

std::string sizes_text(const std::int64_t* sizes, std::size_t count) {
    std::ostringstream text;
    text << "[";
    for (std::size_t i = 0; i < count; ++i) {
        text << (i ? ", " : "");
        if (sizes[i] < 0)
            text << "*";
        else
            text << sizes[i];
    }
    text << "]";
    return text.str();
}

std::string device_text(const Device& device) {
    return device.is_cpu() ? "the CPU" : "cuda:" + std::to_string(device.index());
}

/// Returns a new tensor in the CPU's memory.
Tensor cpu_tensor(const Sizes& sizes, ScalarType type) {
    return torch::stable::empty({sizes.data(), sizes.size()}, type);
}

}  // namespace

Sizes sizes_of(const Tensor& tensor) {
    const auto sizes = tensor.sizes();
    return Sizes(sizes.begin(), sizes.end());
}

Operation::Operation(const char* name, const Tensor& first)
    : name_(name), device_(first.device()), on_device_(python::on_device(first)) {}

void Operation::fail(const std::string& message) const {
    throw std::runtime_error(std::string(name_) + ": " + message);
}

void Operation::fail_launch(int error) const {
    fail(std::string("CUDA reports: ") + device_kernels().error_text(error));
}

Tensor Operation::checked(const char* name, const Tensor& tensor, ScalarType type,
                          const Sizes& sizes) const {
    bool good = tensor.defined() && tensor.device() == device_ && tensor.scalar_type() == type &&
                tensor.dim() == static_cast<std::int64_t>(sizes.size());
    for (std::size_t i = 0; good && i < sizes.size(); ++i)
        good = sizes[i] < 0 || tensor.size(static_cast<std::int64_t>(i)) == sizes[i];
    if (!good) {
        std::ostringstream message;
        message << name << " must be a " << (type == ScalarType::Float ? "float32" : "int32")
                << " tensor on " << device_text(device_) << " of shape "
                << sizes_text(sizes.data(), sizes.size());
        if (tensor.defined()) {
            const auto found = tensor.sizes();
            message << ", found " << torch::headeronly::toString(tensor.scalar_type()) << " "
                    << sizes_text(found.data(), found.size());
            if (tensor.device() != device_) message << " on " << device_text(tensor.device());
        }
        fail(message.str());
    }
    return tensor.is_contiguous() ? tensor : torch::stable::contiguous(tensor);
}

Tensor Operation::empty(const Sizes& sizes, ScalarType type) const {
    if (device_.is_cpu()) return cpu_tensor(sizes, type);
    return torch::stable::empty({sizes.data(), sizes.size()}, type, std::nullopt, device_);
}

Tensor Operation::zeros(const Sizes& sizes, ScalarType type) const {
    Tensor tensor = empty(sizes, type);
    if (on_device_ || type != ScalarType::Float) return torch::stable::zero_(tensor);
    float* values = mutable_floats(tensor);
    const std::int64_t count = tensor.numel();
    // Threads share the zeroing, because most of its time goes to the first touch of new memory.
    constexpr std::int64_t block = 65536;
    parallel_for(
        "zeros", (count + block - 1) / block,
        [&](std::int64_t i) {
            std::fill_n(values + i * block, std::min(block, count - i * block), 0.0f);
        },
        1);
    return tensor;
}

Tensor Operation::on_cpu(const Tensor& tensor) const {
    return tensor.is_cpu() ? tensor
                           : torch::stable::to(tensor, Device(torch::headeronly::DeviceType::CPU));
}

Tensor Operation::upload_bytes(const void* values, std::int64_t bytes, std::int64_t count,
                               ScalarType type) const {
    const Tensor copy = cpu_tensor({count}, type);
    if (count > 0) std::memcpy(copy.mutable_data_ptr(), values, static_cast<std::size_t>(bytes));
    return device_.is_cpu() ? copy : torch::stable::to(copy, device_);
}

Tensor Operation::upside_down(const Tensor& positions, bool bottom_up) const {
    if (!bottom_up) return positions;
    const Tensor turned = empty(sizes_of(positions));
    run<kernels::negate_second_of_four>(
        &cuda::RenderTable::negate_second_of_four,
        kernels::ValueParameters{floats(positions), mutable_floats(turned), 0}, positions.numel());
    return turned;
}

}  // namespace python
}  // namespace item3d
