// The reading of a phrase's location from a prior's cross-attention, the fallback without a
// segmenter.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/region/surface_reading.h"

#include <cstdint>
#include <string>

namespace item3d {

/// Returns the prior's prompt: "the horns" for "horns", "a horns" and "The horns".
std::string attention_prompt(const std::string& words);

/// Returns the share [1, h, w] of the words' own tokens, without the article, in the attention [T,
/// h, w] to the tokens of "the horns". The share is relative to the `tokens` after the start token.
at::Tensor share_of_words(const at::Tensor& attention, std::int64_t tokens);

/// Returns the words' share at points of the surface as a z-score, values [1, K]: 0 is the mean
/// over visible points, 1 a standard deviation above it. The prior must know
/// attention_prompt(words).
SurfaceReading read_attention(const RegionScene& scene, const DiffusionModel& prior,
                              const std::string& words);

}  // namespace item3d
