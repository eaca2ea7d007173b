// The small CLIP beside the prior and its training.
#pragma once

#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/prior/data/labeled_pictures.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

namespace item3d {

ClipConfig prior_clip_config(int vocabulary, int start_of_text, int end_of_text);

/// Copies the vision transformer of a captioner into a CLIP and returns true, where both have the
/// same shape and activation; else returns false. What they do agrees about, not exactly: CLIP has
/// a norm before the first layer, which gets the size that the captioner's states have for
/// pixel_values [N, 3, S, S]. The bias of the captioner's patches goes into the positions.
bool copy_vision(const BlipModel& from, const ClipModel& to, const at::Tensor& pixel_values);

/// Trains it on the pictures and writes it now and then, with all its other files, into its
/// sub-folder of settings.output. Returns {"samples", "loss", ...}. Throws Interrupted after
/// writing a checkpoint. Where settings.begin_with has a CLIP, its weights are begun with:
/// `tokenizer` must then be its. Else its vision transformer starts as that of the captioner in
/// settings.output, where there is one of the same shape.
nlohmann::json train_clip(const LabeledPictures& data, const TrainSettings& settings,
                          const ClipTokenizer& tokenizer, const ClipConfig& config);

}  // namespace item3d
