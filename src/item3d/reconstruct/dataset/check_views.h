// Mistakes in a dataset's pictures and poses, found before anything is learned from them.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <cstddef>
#include <string>
#include <vector>

namespace item3d {

struct ViewProblems {
    std::vector<std::string> warnings;  ///< one line each
    /// Training views whose outlines do not belong to the others': better left out.
    std::vector<std::size_t> contradicting;
};

/// Looks at the training views in a second or so: pictures that are too bright or too dark, masks
/// of what is transparent, outlines that contradict each other. Throws InputError that begins with
/// `subject` where nothing can be learned: bright or dark throughout, mirrored pictures, poses in
/// other axes.
ViewProblems check_views(const Dataset& dataset, const std::string& subject);

}  // namespace item3d
