// Which of a prior's words a CLIP sees on pictures.
#pragma once

#include "item3d/networks/vision_language/clip.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/tensor.h"

#include <string>
#include <vector>

namespace item3d {

/// The word of these kinds ("materials", ...) whose caption is nearest to the pictures on average.
/// pictures: [N, 3, H, W] sRGB in [0, 1]. The vocabulary has words of these kinds.
std::string look_by_clip(const at::Tensor& pictures, const std::string& noun, const Clip& clip,
                         const PriorVocabulary& vocabulary, const std::vector<std::string>& kinds);

}  // namespace item3d
