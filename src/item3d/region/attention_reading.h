// The reading of a phrase's location from a prior's cross-attention, for use without a segmenter.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/region/surface_reading.h"

#include <cstdint>
#include <string>

namespace item3d {

/// Returns the prompt for the prior: "the horns" for "horns", "a horns" and "The horns".
std::string attention_prompt(const std::string& words);

/// Returns the share of the words' own tokens in the attention to "the horns", [1, h, w]. attention
/// is [T, h, w]: the start token, the article, the words, and further tokens. The share is that of
/// the words in the sum of article and words, which are the `tokens` tokens after the start token.
at::Tensor share_of_words(const at::Tensor& attention, std::int64_t tokens);

/// Returns the words' share at points of the surface as z-scores, values [1, K]. 0 is the mean over
/// visible points, and 1 is one standard deviation above it. The prior must know
/// attention_prompt(words).
SurfaceReading read_attention(const RegionScene& scene, const DiffusionModel& prior,
                              const std::string& words);

}  // namespace item3d
