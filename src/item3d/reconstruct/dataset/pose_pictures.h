// The pictures that poses are looked for, by the lens that took them.
#pragma once

#include "item3d/reconstruct/dataset/camera_facts.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Pictures of one size, camera and focal length: one lens stands for all.
struct LensPictures {
    PictureSize size;         ///< as stored
    double focal_pixels = 0;  ///< as EXIF has it; 0: not said
    std::vector<std::filesystem::path> files;
};

struct PosePictures {
    std::vector<std::filesystem::path> files;  ///< all of them, by name
    std::vector<LensPictures> lenses;          ///< the same, in the order of their first pictures
};

/// PNG and JPEG files directly in the folder, by their content. Warns of what is left out. Throws
/// InputError where there are fewer than three.
PosePictures find_pose_pictures(const std::filesystem::path& folder);

}  // namespace item3d
