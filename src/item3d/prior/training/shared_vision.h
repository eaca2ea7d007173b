// A CLIP's vision transformer that starts as a BLIP's.
#pragma once

#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/clip_model.h"

#include <torch/types.h>

namespace item3d {

/// Copies the vision transformer of a captioner into a CLIP and returns true, where both have the
/// same shape and activation; else returns false. What they do agrees about, not exactly: CLIP has
/// a norm before the first layer, which gets the size that the captioner's states have for
/// pixel_values [N, 3, S, S]. The bias of the captioner's patches goes into the positions.
bool copy_vision(const BlipModel& from, const ClipModel& to, const torch::Tensor& pixel_values);

}  // namespace item3d
