// Complete training of the prior's small segmenter: images, network, measurement.
#pragma once

#include "item3d/prior/training/settings.h"

namespace item3d {

/// Fills the segmenter's sub-folder of settings.output, and "segmenter" of its prior.json. Weights
/// start from the segmenter of the prior in settings.init_from, else from the CLIP in
/// settings.output, else from the CLIP of settings.init_from, else at random. Throws Interrupted
/// with its progress kept in the work folder, and InputError for a prior that does not fit.
void train_segmenter_part(const TrainSettings& settings);

}  // namespace item3d
