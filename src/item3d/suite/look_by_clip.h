// Classification of images into a prior's words by CLIP.
#pragma once

#include "item3d/networks/vision_language/clip.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/tensor.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the word of these kinds ("materials", ...) whose caption is nearest to the images on
/// average. images: [N, 3, H, W] sRGB in [0, 1]. The vocabulary must have words of these kinds.
std::string look_by_clip(const at::Tensor& images, const std::string& noun, const Clip& clip,
                         const PriorVocabulary& vocabulary, const std::vector<std::string>& kinds);

}  // namespace item3d
