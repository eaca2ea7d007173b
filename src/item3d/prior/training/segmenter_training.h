// The whole training of the small segmenter beside the prior: pictures, network, measurement.
#pragma once

#include "item3d/prior/training/settings.h"

namespace item3d {

/// Fills the sub-folder of the segmenter in settings.output, and "segmenter" of the prior.json
/// there. It begins with the segmenter of the prior in settings.begin_with, else with the CLIP
/// in settings.output, else with the one in settings.begin_with, else with nothing. Throws
/// Interrupted with what is done in the work folder, and InputError for a prior that does not fit.
void train_segmenter_part(const TrainSettings& settings);

}  // namespace item3d
