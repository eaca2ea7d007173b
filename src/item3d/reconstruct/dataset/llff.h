// LLFF (Mildenhall et al. 2019): poses_bounds.npy beside a folder of pictures.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <filesystem>

namespace item3d {

/// LLFF: poses_bounds.npy [N, 17] of float64 and `images`, in the order of their names.
SourceDataset read_llff(const std::filesystem::path& file, const std::filesystem::path& images);

}  // namespace item3d
