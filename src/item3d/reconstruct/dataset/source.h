// Contents of a dataset's files before any image is read, and helpers of the layouts' readers
// (transforms.h, colmap.h, llff.h).
#pragma once

#include "item3d/core/math.h"
#include "item3d/reconstruct/dataset/lens.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class DatasetKind { nerf_synthetic, nerfstudio, colmap, llff };
/// Returns "NeRF-synthetic", "nerfstudio", "COLMAP" or "LLFF".
const char* dataset_kind_name(DatasetKind kind);

enum class Split { unknown, train, test };

struct SourceView {
    std::string name;  ///< name in the dataset, without extension
    std::filesystem::path image;
    std::filesystem::path mask;  ///< file of the mask; empty if there is none
    /// Pose in the dataset's world, with OpenGL's camera axes: x right, y up, looking along -z.
    Mat4 camera_to_world{1.0f};
    Lens lens;
    Split split = Split::unknown;
};

struct SourceDataset {
    DatasetKind kind = DatasetKind::nerf_synthetic;
    std::vector<SourceView> views;
    /// Up direction of the dataset if its layout fixes it. Otherwise it is estimated from the
    /// cameras.
    std::optional<Vec3> up;
    /// Number of views whose focal length comes from EXIF, because the dataset's files do not have
    /// it.
    std::size_t lenses_of_exif = 0;
};

/// Returns folder / name; Windows separators are accepted. Throws InputError that begins with
/// `subject` if the result is outside the folder.
std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name,
                             const std::string& subject);

/// Returns `path` if this file exists, otherwise the existing file with an added image extension.
/// If there is none, returns `path`.
std::filesystem::path find_image(const std::filesystem::path& path);

/// Removes an image extension: "./train/r_0.png" -> "train/r_0". Other extensions are part of the
/// name.
std::string without_image_extension(const std::string& name);

/// Lists images directly in a folder, by name.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

}  // namespace item3d
