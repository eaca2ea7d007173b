// Where a prior's U-Net reads the words of a phrase: the fallback where no segmenter is there.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/region/surface_reading.h"

#include <cstdint>
#include <string>

namespace item3d {

/// "the horns" of "horns", "a horns" and "The horns": what the prior is asked.
std::string attention_prompt(const std::string& words);

/// [T, h, w] attention to the tokens of "the horns" -> [1, h, w]: the part that the words' own
/// tokens, all but the article's, have of it among the `tokens` behind the start token.
at::Tensor share_of_words(const at::Tensor& attention, std::int64_t tokens);

/// The words' share at points of the surface as a z-score, values [1, K]: 0 is the mean of the
/// seen points, 1 a standard deviation above it. The prior must know attention_prompt(words).
SurfaceReading read_attention(const RegionScene& scene, const DiffusionModel& prior,
                              const std::string& words);

}  // namespace item3d
