// Images for pose estimation, grouped by lens.
#pragma once

#include "item3d/reconstruct/dataset/camera_metadata.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Images of one size, camera and focal length, which share a lens.
struct LensImages {
    ImageSize size;           ///< size as stored
    double focal_pixels = 0;  ///< focal length from EXIF; 0 if unknown
    std::vector<std::filesystem::path> files;
};

struct PoseImages {
    std::vector<std::filesystem::path> files;  ///< all images, by name
    std::vector<LensImages> lenses;            ///< ordered by each lens's first image
};

/// Lists the PNG and JPEG files directly in the folder, recognized by content. Warns of files that
/// are left out. Throws InputError for fewer than three images.
PoseImages find_pose_images(const std::filesystem::path& folder);

}  // namespace item3d
