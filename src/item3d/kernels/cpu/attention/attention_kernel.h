// The attention kernel on plain memory. For query i and key j of one head, with values v and d =
// width, it computes
//
//     s_ij = q_i . k_j      w_ij = e^((s_ij - max_j s_ij) / sqrt(d))
//     y_i = sum_j w_ij v_j / sum_j w_ij
//
// which is softmax(q k^T / sqrt(d)) v of Vaswani et al. 2017, equation 1. Subtracting the maximum
// leaves y_i unchanged and keeps the exponentials from overflowing.
//
//     query, result  [rows, queries, heads, width]      key, value  [rows, keys, heads, width]
//
// One head of one query or key is `width` adjacent numbers; the next query or key lies heads *
// width numbers further.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

#include <cstdint>

namespace item3d {

/// Shape of attention. Queries are [rows, queries, heads * width]; keys and values are [rows, keys,
/// heads * width]. The width of a head is even.
struct AttentionShape {
    std::int64_t rows, heads, queries, keys, width;
};

/// One head of one row, and a range of its queries.
struct AttentionPart {
    std::int64_t row, head, first_query, last_query;
};

template <typename Number>
struct AttentionKernel {
    /// Returns the number of bytes of scratch memory, which must be aligned to 64 bytes, for a
    /// part.
    std::int64_t (*scratch)(const AttentionShape& shape);
    /// Writes softmax(q k^T / sqrt(width)) v for a part. Scores and sums are float. The values of
    /// the softmax are rounded to Number before they are multiplied.
    void (*attend)(const AttentionShape& shape, const Number* query, const Number* key,
                   const Number* value, const AttentionPart& part, Number* result, void* scratch);
};

template <InstructionSet instructions, typename Number>
AttentionKernel<Number> attention_kernel();
template <>
AttentionKernel<float> attention_kernel<InstructionSet::avx2, float>();
template <>
AttentionKernel<float> attention_kernel<InstructionSet::avx512, float>();
template <>
AttentionKernel<BFloat16> attention_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
