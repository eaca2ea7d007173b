// Text embeddings as the U-Net reads them.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

/// Embeddings of prompts, one row each. Both tensors take the same path through guidance and
/// sampling.
struct TextEmbedding {
    at::Tensor states;       ///< [N, S, D] hidden states
    at::Tensor pooled = {};  ///< [N, P] of the second encoder; defined for SDXL only

    std::int64_t rows() const { return states.size(0); }
    /// Returns row i as [1, ...].
    TextEmbedding row(std::int64_t i) const;
    /// Repeats a single row to `rows` rows.
    TextEmbedding expand(std::int64_t rows) const;
    /// Concatenates the rows of both.
    static TextEmbedding join(const TextEmbedding& first, const TextEmbedding& second);
};

}  // namespace item3d
