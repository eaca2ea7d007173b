// What the text encoders say about prompts, as the U-Net reads it.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

/// A row for each prompt. Both tensors take the same path through guidance and sampling.
struct TextEmbedding {
    at::Tensor states;       ///< [N, S, D] hidden states
    at::Tensor pooled = {};  ///< [N, P] of the second encoder; undefined but for SDXL

    std::int64_t rows() const { return states.size(0); }
    /// [1, ...] of row i.
    TextEmbedding row(std::int64_t i) const;
    /// One row for all of them.
    TextEmbedding expand(std::int64_t rows) const;
    /// Rows of both, one after the other.
    static TextEmbedding join(const TextEmbedding& first, const TextEmbedding& second);
};

}  // namespace item3d
