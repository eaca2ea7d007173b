// Directions between sentences, in the space of their embeddings.
#pragma once

#include "item3d/networks/diffusion/text_embedding.h"

namespace item3d {

TextEmbedding scaled(const TextEmbedding& text, double factor);

/// Returns a + factor b, row by row.
TextEmbedding add_scaled(const TextEmbedding& a, const TextEmbedding& b, double factor);

/// Returns the Euclidean norm over all elements.
double length_of(const TextEmbedding& text);

/// Comparison of two directions to the target: the current one, from the adjusted source, with the
/// initial one.
struct TextDirection {
    double angle = 0;   ///< degrees between the two; 0 if one has length 0
    double length = 1;  ///< relative to the initial length
};

/// One row each; source: the prompt's embedding; adjusted: its current version.
TextDirection compare_directions(const TextEmbedding& target, const TextEmbedding& source,
                                 const TextEmbedding& adjusted);

}  // namespace item3d
