// What the files of a dataset say, before any picture is read, and what the readers of the layouts
// (transforms.h, colmap.h, llff.h) share.
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
    std::size_t lenses_of_exif = 0;  ///< views whose focal length no file of the dataset names
};

/// folder / name, whose separators may be those of Windows. Throws InputError that begins with
/// `subject` where that is outside the folder.
std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name,
                             const std::string& subject);

/// The file itself, or the one with an image's extension; as given where there is none.
std::filesystem::path find_picture(const std::filesystem::path& path);

/// "./train/r_0.png" -> "train/r_0". What is no image's extension is part of the name.
std::string without_picture_extension(const std::string& name);

/// Pictures directly in a folder, by name.
std::vector<std::filesystem::path> list_pictures(const std::filesystem::path& folder);

}  // namespace item3d
