// Readers of both layouts of transforms.json: NeRF-synthetic (Mildenhall et al. 2020) and
// nerfstudio's.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <filesystem>

namespace item3d {

/// Reads the NeRF-synthetic layout from `folder`: transforms_train.json, transforms_test.json if
/// present, and transforms_val.json if there is no test file.
SourceDataset read_nerf_synthetic(const std::filesystem::path& folder);

/// Reads the layouts of nerfstudio and instant-ngp. One transforms.json has intrinsics and
/// distortion for all frames or for each frame, mask_path, and lists of file names for the splits.
SourceDataset read_nerfstudio(const std::filesystem::path& file);

}  // namespace item3d
