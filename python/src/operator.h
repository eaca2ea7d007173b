// Common parts of the operators: checks of tensors, new tensors, and sums of many pixels'
// contributions. The tensors are those of LibTorch's stable interface, so that one library serves
// many LibTorch versions.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/parallel.h"

#include <torch/csrc/stable/library.h>
#include <torch/csrc/stable/ops.h>
#include <torch/csrc/stable/tensor.h>

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#if defined(__x86_64__) && defined(__GLIBC__)
// LibTorch's headers call it; glibc 2.34 gave it a new version, which older systems do not have.
__asm__(".symver dlsym,dlsym@GLIBC_2.2.5");
#endif

namespace item3d::python {

using torch::headeronly::ScalarType;
using torch::stable::Tensor;
using Sizes = std::vector<std::int64_t>;

/// Throws std::runtime_error with the message "operation: message". Python sees a RuntimeError.
[[noreturn]] void fail(const char* operation, const std::string& message);

/// Returns the tensor, made contiguous. Throws like fail() unless the tensor is on the CPU and has
/// the given type and sizes. A size of -1 allows any number.
Tensor checked(const char* operation, const char* name, const Tensor& tensor, ScalarType type,
               const Sizes& sizes);

/// Throws like fail() if any value of a float32 tensor is NaN or infinite.
void check_finite(const char* operation, const char* name, const Tensor& tensor);

/// Throws like fail() unless all indices of triangles [T, 3] are in [0, vertices).
void check_indices(const char* operation, const Tensor& triangles, std::int64_t vertices);

/// Returns an uninitialised tensor on the CPU, float32 by default.
Tensor new_tensor(const Sizes& sizes, ScalarType type = ScalarType::Float);
Tensor new_zeros(const Sizes& sizes);

inline const float* floats(const Tensor& tensor) {
    return static_cast<const float*>(tensor.const_data_ptr());
}
inline const std::int32_t* integers(const Tensor& tensor) {
    return static_cast<const std::int32_t*>(tensor.const_data_ptr());
}
inline float* mutable_floats(const Tensor& tensor) {
    return static_cast<float*>(tensor.mutable_data_ptr());
}

/// Returns a copy of positions [.., 4] with y negated if `bottom_up` is true, otherwise an empty
/// vector.
std::vector<float> upside_down(const Tensor& positions, bool bottom_up);

/// Converts, in place, a gradient with respect to the copy of upside_down() to the gradient with
/// respect to the positions.
void turn_gradient(float* gradient, std::int64_t count, bool bottom_up);

/// Value of sum_pixels()'s max_ratio for sums into the texels of environment maps.
inline constexpr std::int64_t large_map_ratio = 64;

/// Adds add(i, sums) for all i in [0, count) to `out`, which holds `elements` zeros. The work is
/// split into pieces with buffers of their own if there are at most `max_ratio` elements for each
/// pixel. The split depends only on the sizes, and the pieces' sums are added in order, so the
/// bytes of the result are the same for any number of threads.
template <typename Add>
void sum_pixels(std::int64_t count, std::int64_t elements, float* out, const Add& add,
                std::int64_t max_ratio = 2) {
    constexpr std::int64_t max_pieces = 8;
    const std::int64_t pieces = count < 16384 || elements > max_ratio * count ? 1 : max_pieces;
    std::vector<float> buffers(static_cast<std::size_t>((pieces - 1) * elements));
    parallel_for(
        "sum_pixels", pieces,
        [&](std::int64_t piece) {
            Accumulator sums;
            sums.values = piece == 0 ? out : buffers.data() + (piece - 1) * elements;
            for (std::int64_t i = count * piece / pieces; i < count * (piece + 1) / pieces; ++i)
                add(i, sums);
        },
        1);
    if (pieces == 1) return;
    parallel_for(
        "sum_pieces", elements,
        [&](std::int64_t i) {
            for (std::int64_t piece = 1; piece < pieces; ++piece)
                out[i] += buffers[static_cast<std::size_t>((piece - 1) * elements + i)];
        },
        65536);
}

}  // namespace item3d::python
