// The directions between sentences, in the space of their embeddings.
#pragma once

#include "item3d/networks/diffusion/text_embedding.h"

namespace item3d {

TextEmbedding scaled(const TextEmbedding& text, double factor);

/// Returns a + factor b, row by row.
TextEmbedding add_scaled(const TextEmbedding& a, const TextEmbedding& b, double factor);

/// Returns the Euclidean norm over all elements.
double length_of(const TextEmbedding& text);

/// The current direction, from the adjusted source to the target, compared with the initial
/// direction, from the source prompt to the target.
struct TextDirection {
    double angle = 0;   ///< degrees between the directions; 0 if one has length 0
    double length = 1;  ///< length of the current direction, relative to the initial one
};

/// Returns the comparison. source: the source prompt's embedding; adjusted: its current version.
/// Each embedding has one row.
TextDirection compare_directions(const TextEmbedding& target, const TextEmbedding& source,
                                 const TextEmbedding& adjusted);

}  // namespace item3d
