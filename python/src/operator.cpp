#include "python/src/operator.h"

#include <algorithm>
#include <atomic>
#include <bit>
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

}  // namespace

void fail(const char* operation, const std::string& message) {
    throw std::runtime_error(std::string(operation) + ": " + message);
}

Tensor checked(const char* operation, const char* name, const Tensor& tensor, ScalarType type,
               const Sizes& sizes) {
    bool good = tensor.defined() && tensor.is_cpu() && tensor.scalar_type() == type &&
                tensor.dim() == static_cast<std::int64_t>(sizes.size());
    for (std::size_t i = 0; good && i < sizes.size(); ++i)
        good = sizes[i] < 0 || tensor.size(static_cast<std::int64_t>(i)) == sizes[i];
    if (!good) {
        std::ostringstream message;
        message << name << " must be a " << (type == ScalarType::Float ? "float32" : "int32")
                << " tensor on the CPU of shape " << sizes_text(sizes.data(), sizes.size());
        if (tensor.defined()) {
            const auto found = tensor.sizes();
            message << ", found " << torch::headeronly::toString(tensor.scalar_type()) << " "
                    << sizes_text(found.data(), found.size());
        }
        fail(operation, message.str());
    }
    return tensor.is_contiguous() ? tensor : torch::stable::contiguous(tensor);
}

void check_finite(const char* operation, const char* name, const Tensor& tensor) {
    const float* values = floats(tensor);
    std::atomic<bool> good{true};
    constexpr std::int64_t block = 65536;
    const std::int64_t count = tensor.numel();
    parallel_for(
        "check_finite", (count + block - 1) / block,
        [&](std::int64_t i) {
            std::uint32_t bad = 0;
            for (std::int64_t k = i * block; k < std::min(count, (i + 1) * block); ++k)
                bad |= (std::bit_cast<std::uint32_t>(values[k]) & 0x7f800000u) == 0x7f800000u;
            if (bad != 0) good = false;
        },
        1);
    if (!good) fail(operation, std::string(name) + " must be finite, found NaN or infinity");
}

void check_indices(const char* operation, const Tensor& triangles, std::int64_t vertices) {
    const std::int32_t* corners = integers(triangles);
    const std::int64_t count = triangles.numel();
    std::int32_t low = 0, high = -1;
    for (std::int64_t i = 0; i < count; ++i) {
        low = std::min(low, corners[i]);
        high = std::max(high, corners[i]);
    }
    if (low < 0 || high >= vertices)
        fail(operation, "triangles must name vertices from 0 to " + std::to_string(vertices - 1) +
                            ", found " + std::to_string(low < 0 ? low : high));
}

Tensor new_tensor(const Sizes& sizes, ScalarType type) {
    return torch::stable::empty({sizes.data(), sizes.size()}, type);
}

Tensor new_zeros(const Sizes& sizes) {
    Tensor tensor = new_tensor(sizes);
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

std::vector<float> upside_down(const Tensor& positions, bool bottom_up) {
    if (!bottom_up) return {};
    const float* in = floats(positions);
    std::vector<float> turned(in, in + positions.numel());
    for (std::size_t i = 1; i < turned.size(); i += 4)
        turned[i] = -turned[i];
    return turned;
}

void turn_gradient(float* gradient, std::int64_t count, bool bottom_up) {
    for (std::int64_t i = 1; bottom_up && i < count; i += 4)
        gradient[i] = -gradient[i];
}

}  // namespace python
}  // namespace item3d
