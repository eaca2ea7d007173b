// Text embeddings as the U-Net reads them.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

/// Embeddings of N prompts.
struct TextEmbedding {
    at::Tensor states;       ///< [N, S, D] hidden states of S tokens
    at::Tensor pooled = {};  ///< [N, P] pooled states of the second encoder; defined for SDXL only

    std::int64_t rows() const { return states.size(0); }
    /// Returns the embedding of prompt i as [1, ...].
    TextEmbedding row(std::int64_t i) const;
    /// Repeats the embedding of a single prompt `rows` times.
    TextEmbedding expand(std::int64_t rows) const;
    /// Concatenates two embeddings along the batch.
    static TextEmbedding join(const TextEmbedding& first, const TextEmbedding& second);
};

}  // namespace item3d
