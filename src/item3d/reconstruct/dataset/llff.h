// Reader of LLFF datasets (Mildenhall et al. 2019): poses_bounds.npy beside a folder of images.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <filesystem>

namespace item3d {

/// Reads poses_bounds.npy [N, 17] of float64; the N images in `images` are sorted by name.
SourceDataset read_llff(const std::filesystem::path& file, const std::filesystem::path& images);

}  // namespace item3d
