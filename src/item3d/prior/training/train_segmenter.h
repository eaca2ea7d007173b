// The small segmenter beside the prior and its training.
#pragma once

#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/networks/vision_language/clip_seg.h"
#include "item3d/prior/data/part_pictures.h"
#include "item3d/prior/training/settings.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

ClipSegConfig prior_segmenter_config(int vocabulary, int start_of_text, int end_of_text);

/// Copies what a CLIP has learnt of words and pictures into a segmenter and returns true, where its
/// layers are of the same sizes and there are enough of them; else returns false. Patches and
/// positions are resampled where a picture has another number of them.
bool copy_clip(const ClipModel& from, const ClipSegModel& to);

/// Trains it on the pictures and writes it now and then, with all its other files, into its
/// sub-folder of settings.output. Returns {"samples", "loss", ...}. Throws Interrupted after
/// writing a checkpoint. `begin`: the folder of a segmenter or CLIP to begin with, whose tokenizer
/// `tokenizer` must then be; empty: with nothing.
nlohmann::json train_segmenter(const PartPictures& data, const TrainSettings& settings,
                               const ClipTokenizer& tokenizer, const ClipSegConfig& config,
                               const std::filesystem::path& begin = {});

}  // namespace item3d
