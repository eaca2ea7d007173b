// Pose estimation of photographs by COLMAP (Schoenberger and Frahm 2016), a separate program.
#pragma once

#include <filesystem>

namespace item3d {

struct PoseSearch {
    std::filesystem::path images;  ///< folder of PNG and JPEG files; other files are ignored
    /// Folder of masks; may be empty. Masks are used only if each image has a mask with COLMAP's
    /// name (PICTURE.jpg.png). COLMAP then uses features of the object alone, which is necessary if
    /// the object was turned in front of a fixed camera. If COLMAP finds fewer than half of the
    /// poses with masks, it runs again without them.
    std::filesystem::path masks;
    std::filesystem::path output;  ///< folder, created if missing
    int threads = 0;               ///< number of threads; 0 for one per core
};

/// Runs COLMAP's feature_extractor, exhaustive_matcher and mapper. For more than 150 images,
/// sequential_matcher replaces exhaustive_matcher, with the images in the order of their names.
/// Returns the folder output/colmap. load_dataset() reads this folder as a COLMAP dataset, with
/// DatasetOptions::images = search.images. Images of one size, camera and focal length (EXIF) share
/// a lens. COLMAP refines the lens's focal length, starting from EXIF's. The result of an earlier
/// search of the same images and masks is reused. Throws InputError for fewer than three images or
/// poses, ResourceError if the program `colmap` is missing or fails (output/colmap.log has
/// details), and Interrupted after Ctrl-C. Only a successful search leaves output/colmap.
std::filesystem::path find_poses(const PoseSearch& search);

}  // namespace item3d
