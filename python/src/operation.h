// One call of an operator: checks of its tensors, new tensors, and the loops of its kernels, on the
// CPU or on a CUDA device. The tensors are those of LibTorch's stable interface, so that one
// library serves many LibTorch versions.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/parallel.h"
#include "python/src/device.h"

#include <torch/csrc/stable/library.h>
#include <torch/csrc/stable/ops.h>
#include <torch/csrc/stable/tensor.h>

#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace item3d::python {

using torch::headeronly::ScalarType;
using torch::stable::Tensor;
using Sizes = std::vector<std::int64_t>;

inline const float* floats(const Tensor& tensor) {
    return static_cast<const float*>(tensor.const_data_ptr());
}
inline const std::int32_t* integers(const Tensor& tensor) {
    return static_cast<const std::int32_t*>(tensor.const_data_ptr());
}
inline float* mutable_floats(const Tensor& tensor) {
    return static_cast<float*>(tensor.mutable_data_ptr());
}
/// Returns the sizes of a tensor.
Sizes sizes_of(const Tensor& tensor);

/// Memory for the time of a call, on the CPU or on a device. It costs less than a tensor.
template <typename T>
class Scratch {
  public:
    explicit Scratch(std::int64_t count)
        : host_(std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(count))),
          data_(host_.get()) {}
    explicit Scratch(const Tensor& device)
        : device_(device), data_(static_cast<T*>(device.mutable_data_ptr())) {}

    T* data() const { return data_; }

  private:
    std::unique_ptr<T[]> host_;
    Tensor device_;
    T* data_;
};

/// Value of sum()'s max_ratio for sums into the texels of environment maps.
inline constexpr std::int64_t large_map_ratio = 64;

class Operation {
  public:
    /// name: for messages. first: any tensor of the call; the others must be on the same device.
    Operation(const char* name, const Tensor& first);

    bool on_device() const { return on_device_; }

    /// Throws std::runtime_error with the message "name: message". Python sees a RuntimeError.
    [[noreturn]] void fail(const std::string& message) const;

    /// Returns the tensor, made contiguous. Throws like fail() unless the tensor is on the call's
    /// device and has the given type and sizes. A size of -1 allows any number.
    Tensor checked(const char* name, const Tensor& tensor, ScalarType type,
                   const Sizes& sizes) const;

    /// Return new tensors on the call's device, float32 by default.
    Tensor empty(const Sizes& sizes, ScalarType type = ScalarType::Float) const;
    Tensor zeros(const Sizes& sizes, ScalarType type = ScalarType::Float) const;
    /// Returns uninitialised memory on the call's device.
    template <typename T>
    Scratch<T> scratch(std::int64_t count) const {
        const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
        if (on_device_) return Scratch<T>(empty({bytes}, ScalarType::Byte));
        try {
            return Scratch<T>(count);
        } catch (const std::bad_alloc&) {
            fail("there is no memory for " + std::to_string(bytes >> 20) + " MB");
        }
    }
    /// Returns the tensor in the CPU's memory. It is the same tensor if it is there already.
    Tensor on_cpu(const Tensor& tensor) const;
    /// Returns a copy [count] of values in the CPU's memory. type: that of T.
    template <typename T>
    Tensor upload(const T* values, std::int64_t count, ScalarType type) const;

    /// Returns positions [.., 4], with y negated if `bottom_up` is true.
    Tensor upside_down(const Tensor& positions, bool bottom_up) const;

    template <typename Parameters>
    using Entry = cuda::Kernel<Parameters> cuda::RenderTable::*;

    /// Calls start(kernels, stream) for the call's device, and throws like fail() if it returns an
    /// error of CUDA.
    template <typename Start>
    void launch(const Start& start) const;
    /// Launches an entry of the device's kernels.
    template <typename Parameters>
    void launch(Entry<Parameters> entry, const Parameters& parameters, std::int64_t count) const;

    /// Runs kernel(parameters, i) for every i in [0, count): on the CPU's threads, or by `entry` on
    /// the device. grain: indices that stay on one thread of the CPU.
    template <auto kernel, typename Parameters>
    void run(Entry<Parameters> entry, const Parameters& parameters, std::int64_t count,
             std::int64_t grain = 4096) const;

    /// Returns sums of shape `sizes`. On the CPU, add(i, sums) adds the terms of every i in
    /// [0, count); on the device, launch_sum(sums) launches kernels that add them, in any order. On
    /// the CPU the work is split into pieces with buffers of their own if there are at most
    /// `max_ratio` elements for each i. The split depends only on the sizes, and the pieces' sums
    /// are added in order, so the bytes of the result are the same for any number of threads.
    template <typename Add, typename LaunchSum>
    Tensor sum(std::int64_t count, const Sizes& sizes, const Add& add, const LaunchSum& launch_sum,
               std::int64_t max_ratio = 2) const;

    /// Does the work of sum() without sums: calls add and launch_sum with an accumulator that is
    /// not wanted.
    template <typename Add, typename LaunchSum>
    void visit(std::int64_t count, const Add& add, const LaunchSum& launch_sum,
               std::int64_t grain = 4096) const;

  private:
    Tensor upload_bytes(const void* values, std::int64_t bytes, std::int64_t count,
                        ScalarType type) const;
    [[noreturn]] void fail_launch(int error) const;

    const char* name_;
    torch::stable::Device device_;
    bool on_device_;
};

template <typename T>
Tensor Operation::upload(const T* values, std::int64_t count, ScalarType type) const {
    return upload_bytes(values, count * static_cast<std::int64_t>(sizeof(T)), count, type);
}

template <typename Start>
void Operation::launch(const Start& start) const {
    const cuda::RenderTable& kernels = device_kernels();
    const DeviceGuard guard(device_.index());
    const int error = start(kernels, guard.stream());
    if (error != 0) fail_launch(error);
}

template <typename Parameters>
void Operation::launch(Entry<Parameters> entry, const Parameters& parameters,
                       std::int64_t count) const {
    launch([&](const cuda::RenderTable& kernels, cuda::Stream stream) {
        return (kernels.*entry)(parameters, count, stream);
    });
}

template <auto kernel, typename Parameters>
void Operation::run(Entry<Parameters> entry, const Parameters& parameters, std::int64_t count,
                    std::int64_t grain) const {
    if (on_device_)
        launch(entry, parameters, count);
    else
        parallel_for(
            name_, count, [&](std::int64_t i) { kernel(parameters, i); }, grain);
}

template <typename Add, typename LaunchSum>
Tensor Operation::sum(std::int64_t count, const Sizes& sizes, const Add& add,
                      const LaunchSum& launch_sum, std::int64_t max_ratio) const {
    const Tensor result = zeros(sizes);
    float* out = mutable_floats(result);
    if (on_device_) {
        Accumulator sums;
        sums.values = out;
        launch_sum(sums);
        return result;
    }
    constexpr std::int64_t max_pieces = 8;
    const std::int64_t elements = result.numel();
    const std::int64_t pieces = count < 16384 || elements > max_ratio * count ? 1 : max_pieces;
    std::vector<float> buffers(static_cast<std::size_t>((pieces - 1) * elements));
    parallel_for(
        "sum", pieces,
        [&](std::int64_t piece) {
            Accumulator sums;
            sums.values = piece == 0 ? out : buffers.data() + (piece - 1) * elements;
            for (std::int64_t i = count * piece / pieces; i < count * (piece + 1) / pieces; ++i)
                add(i, sums);
        },
        1);
    if (pieces == 1) return result;
    parallel_for(
        "sum_pieces", elements,
        [&](std::int64_t i) {
            for (std::int64_t piece = 1; piece < pieces; ++piece)
                out[i] += buffers[static_cast<std::size_t>((piece - 1) * elements + i)];
        },
        65536);
    return result;
}

template <typename Add, typename LaunchSum>
void Operation::visit(std::int64_t count, const Add& add, const LaunchSum& launch_sum,
                      std::int64_t grain) const {
    if (on_device_)
        launch_sum(Accumulator{});
    else
        parallel_for(
            name_, count, [&](std::int64_t i) { add(i, Accumulator{}); }, grain);
}

}  // namespace item3d::python
