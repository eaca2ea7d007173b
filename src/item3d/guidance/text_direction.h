// Directions between sentences, in the space of their embeddings.
#pragma once

#include "item3d/networks/diffusion/text_embedding.h"

namespace item3d {

TextEmbedding scaled(const TextEmbedding& text, double factor);

/// a + factor b, row by row.
TextEmbedding add_scaled(const TextEmbedding& a, const TextEmbedding& b, double factor);

/// Euclidean, of all numbers together.
double length_of(const TextEmbedding& text);

/// Where the direction to the target points now, beside where it pointed at first.
struct TextDirection {
    double angle = 0;   ///< degrees between the two; 0 where one of them has no length
    double length = 1;  ///< as a part of the first one's
};

/// One row each; source: the prompt's embedding; adjusted: what stands for it now.
TextDirection compare_directions(const TextEmbedding& target, const TextEmbedding& source,
                                 const TextEmbedding& adjusted);

}  // namespace item3d
