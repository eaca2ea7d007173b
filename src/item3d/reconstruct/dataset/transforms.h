// The two layouts of transforms.json: NeRF-synthetic (Mildenhall et al. 2020) and nerfstudio's.
#pragma once

#include "item3d/reconstruct/dataset/source.h"

#include <filesystem>

namespace item3d {

/// NeRF-synthetic: transforms_train.json and, where they are, transforms_val.json (left out, unless
/// there is no test file) and transforms_test.json. `folder` holds them.
SourceDataset read_nerf_synthetic(const std::filesystem::path& folder);

/// nerfstudio, instant-ngp: one transforms.json with intrinsics and distortion for all or each
/// frame, mask_path, and lists of file names for the splits.
SourceDataset read_nerfstudio(const std::filesystem::path& file);

}  // namespace item3d
