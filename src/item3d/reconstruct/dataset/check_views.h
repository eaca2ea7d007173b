// Check of a dataset's images and poses before optimisation.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <cstddef>
#include <string>
#include <vector>

namespace item3d {

struct ViewProblems {
    std::vector<std::string> warnings;  ///< one line each
    /// Training views whose outlines contradict those of other views. They should be left out.
    std::vector<std::size_t> contradicting;
};

/// Checks the training views for over- and underexposed images, masks of transparent objects, and
/// outlines that contradict each other. This takes about a second. Throws InputError that begins
/// with `subject` if the dataset is unusable, because most images are overexposed or black, images
/// are mirrored, or poses use other axes.
ViewProblems check_views(const Dataset& dataset, const std::string& subject);

}  // namespace item3d
