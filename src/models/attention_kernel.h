// Attention on plain memory: AVX-512, compiled for it alone (src/CMakeLists.txt), so nothing here
// may be called where matrix_kernel_runs() says no.
#pragma once

#include "item3d/models/matrix_kernel.h"

#include <cstdint>

namespace item3d {

/// Queries, keys and values are [rows, places, heads * width]; the width of a head is even.
struct AttentionShape {
    std::int64_t rows, heads, queries, keys, width;
};

/// Bytes of scratch memory (64-byte aligned) for a part.
template <typename Number>
std::int64_t attention_scratch(const AttentionShape& shape);

/// One head of one row, and a range of its queries.
struct AttentionPart {
    std::int64_t row, head, first_query, last_query;
};

/// Writes softmax(q k^T / sqrt(width)) v of a part. Scores and sums are float, the
/// softmax's values are rounded to Number before they are multiplied.
template <typename Number>
void attend(const AttentionShape& shape, const Number* query, const Number* key,
            const Number* value, const AttentionPart& part, Number* result, void* scratch);

}  // namespace item3d
