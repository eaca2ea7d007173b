// Readers of both layouts of transforms.json: NeRF-synthetic (Mildenhall et al. 2020) and
// nerfstudio's.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <filesystem>

namespace item3d {

/// Reads NeRF-synthetic: transforms_train.json, transforms_test.json if present, and
/// transforms_val.json if there is no test file. `folder` holds them.
SourceDataset read_nerf_synthetic(const std::filesystem::path& folder);

/// Reads nerfstudio and instant-ngp: one transforms.json with intrinsics and distortion for all
/// frames or for each frame, mask_path, and lists of file names for the splits.
SourceDataset read_nerfstudio(const std::filesystem::path& file);

}  // namespace item3d
