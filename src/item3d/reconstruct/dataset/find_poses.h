// Photographs without poses: COLMAP (Schoenberger and Frahm 2016), a program of its own, finds
// where the camera stood.
#pragma once

#include <filesystem>

namespace item3d {

struct PoseSearch {
    std::filesystem::path
        images;  ///< folder of PNG and JPEG files; what else lies there is ignored
    /// Folder of masks; empty: none. COLMAP looks at them only where each picture has one that is
    /// named as COLMAP wants it (PICTURE.jpg.png): it then ignores all but the object, as needed
    /// where the object turned before a fixed camera. Where that finds fewer than half of the
    /// poses, it looks at the surroundings too.
    std::filesystem::path masks;
    std::filesystem::path output;  ///< folder, made when it is not there
    int threads = 0;               ///< 0: one for each core
};

/// Runs COLMAP's feature_extractor, exhaustive_matcher (above 150 pictures sequential_matcher,
/// which takes them in the order of their names) and mapper, and returns output/colmap, a dataset
/// of the kind COLMAP for load_dataset() with DatasetOptions::images = search.images. Pictures of
/// one size, camera and focal length (EXIF) share a lens, whose focal length is looked for from
/// EXIF's on. What an earlier search found for the same pictures and masks is taken again.
///
/// Throws InputError where there are fewer than three pictures or poses, ResourceError where the
/// program `colmap` is missing or fails (output/colmap.log then tells more), Interrupted after
/// Ctrl-C. Only a search that went well leaves output/colmap.
std::filesystem::path find_poses(const PoseSearch& search);

}  // namespace item3d
