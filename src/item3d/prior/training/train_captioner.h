// The prior's small captioner and its training.
#pragma once

#include "item3d/networks/vision_language/blip.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/labeled_images.h"
#include "item3d/prior/training/settings.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace item3d {

BlipConfig prior_captioner_config(int vocabulary);

/// Trains the captioner on the images and writes it periodically, with all its other files, into
/// its sub-folder of settings.output. Returns {"samples", "loss", ...}. Throws Interrupted after
/// writing a checkpoint. If settings.init_from has a captioner, the training starts from its
/// weights and vocabulary. Otherwise the vocabulary is `words`.
nlohmann::json train_captioner(const LabeledImages& data, const TrainSettings& settings,
                               const std::vector<WordCount>& words, BlipConfig config);

}  // namespace item3d
