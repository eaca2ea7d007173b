// The prior's small CLIP and its training.
#pragma once

#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/prior/data/labeled_images.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

namespace item3d {

ClipConfig prior_clip_config(int vocabulary, int start_of_text, int end_of_text);

/// Copies the vision transformer of a captioner into a CLIP. Returns false if shapes or activations
/// differ. The outputs agree approximately: CLIP has a norm before the first layer, which gets the
/// scale of the captioner's states for pixel_values [N, 3, S, S]. The bias of the captioner's patch
/// embedding is added to CLIP's position embeddings.
bool copy_vision(const BlipModel& from, const ClipModel& to, const at::Tensor& pixel_values);

/// Trains CLIP on the images and writes it periodically, with all its other files, into its
/// sub-folder of settings.output. Returns {"samples", "loss", ...}. Throws Interrupted after
/// writing a checkpoint. If settings.init_from has a CLIP, the training starts from its weights,
/// and `tokenizer` must be that CLIP's tokenizer. Otherwise the initial vision transformer is
/// copied from the captioner in settings.output, if that captioner has one of the same shape.
nlohmann::json train_clip(const LabeledImages& data, const TrainSettings& settings,
                          const ClipTokenizer& tokenizer, const ClipConfig& config);

}  // namespace item3d
