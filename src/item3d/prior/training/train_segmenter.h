// The prior's small segmenter and its training.
#pragma once

#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/networks/vision_language/clip_seg.h"
#include "item3d/prior/data/part_images.h"
#include "item3d/prior/training/settings.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

ClipSegConfig prior_segmenter_config(int vocabulary, int start_of_text, int end_of_text);

/// Copies the encoders of a CLIP into a segmenter. Returns false if the CLIP's layers are of other
/// sizes or too few. Patches and positions are resampled if the segmenter divides an image into
/// another number of patches.
bool copy_clip(const ClipModel& from, const ClipSegModel& to);

/// Trains the segmenter on the images and writes it periodically, with all its other files, into
/// its sub-folder of settings.output. Returns {"samples", "loss", ...}. Throws Interrupted after
/// writing a checkpoint. begin: folder of a segmenter or CLIP whose weights the training starts
/// from, if not empty. `tokenizer` must be the tokenizer of this network.
nlohmann::json train_segmenter(const PartImages& data, const TrainSettings& settings,
                               const ClipTokenizer& tokenizer, const ClipSegConfig& config,
                               const std::filesystem::path& begin = {});

}  // namespace item3d
