// What the files of a dataset say, before any picture is read: one reader for each layout.
#pragma once

#include "item3d/core/math.h"
#include "item3d/reconstruct/dataset/lens.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class DatasetKind { nerf_synthetic, nerfstudio, colmap, llff };
/// "NeRF-synthetic", "nerfstudio", "COLMAP", "LLFF".
const char* dataset_kind_name(DatasetKind kind);

enum class Split { unknown, train, test };

struct SourceView {
    std::string name;  ///< as the dataset writes it, no extension
    std::filesystem::path picture;
    std::filesystem::path mask;  ///< empty: none is named
    Mat4 camera_to_world{1.0f};  ///< OpenGL axes (x right, y up, looks along -z), dataset's world
    Lens lens;
    Split split = Split::unknown;
};

struct SourceDataset {
    DatasetKind kind = DatasetKind::nerf_synthetic;
    std::vector<SourceView> views;
    /// The dataset's up direction where its layout fixes it; else it is told from the cameras.
    std::optional<Vec3> up;
};

/// NeRF-synthetic: transforms_train.json and, where they are, transforms_val.json (left out, unless
/// there is no test file) and transforms_test.json. `folder` holds them.
SourceDataset read_nerf_synthetic(const std::filesystem::path& folder);

/// nerfstudio, instant-ngp: one transforms.json with intrinsics and distortion for all or each
/// frame, mask_path, and lists of file names for the splits.
SourceDataset read_nerfstudio(const std::filesystem::path& file);

/// COLMAP's cameras and images, text or binary, in `model`; picture names are relative to `images`.
/// Models SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE,
/// SIMPLE_RADIAL_FISHEYE and RADIAL_FISHEYE.
SourceDataset read_colmap(const std::filesystem::path& model, const std::filesystem::path& images);

/// LLFF: poses_bounds.npy [N, 17] of float64 and `images`, in the order of their names.
SourceDataset read_llff(const std::filesystem::path& file, const std::filesystem::path& images);

/// folder / name. Throws InputError that begins with `subject` where that is outside the folder.
std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name,
                             const std::string& subject);

/// The file itself, or the one with an image's extension; as given where there is none.
std::filesystem::path find_picture(const std::filesystem::path& path);

/// "./train/r_0.png" -> "train/r_0". What is no image's extension is part of the name.
std::string without_picture_extension(const std::string& name);

/// Pictures directly in a folder, by name.
std::vector<std::filesystem::path> list_pictures(const std::filesystem::path& folder);

}  // namespace item3d
