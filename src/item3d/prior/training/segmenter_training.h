// Complete training of the prior's small segmenter: drawing of the images, training of the network,
// and measurement.
#pragma once

#include "item3d/prior/training/settings.h"

namespace item3d {

/// Fills the segmenter's sub-folder of settings.output, and "segmenter" of its prior.json. The
/// initial weights are those of the first network that exists: the segmenter of the prior in
/// settings.init_from, the CLIP in settings.output, the CLIP of the prior in settings.init_from. If
/// none exists, they are random. Throws Interrupted, with the progress kept in the work folder, and
/// InputError for a prior that does not fit.
void train_segmenter_part(const TrainSettings& settings);

}  // namespace item3d
