// Folders of reference data, which other software has made.
#pragma once

#include <filesystem>
#include <vector>

namespace item3d::reference_data {

/// Returns the folder in the repository, which has crops of large files and all of the small files.
inline std::filesystem::path crops() {
    return std::filesystem::path(ITEM3D_TEST_DATA) / "references";
}

/// Returns the folder of the whole data, beside the repository. Few machines have it.
inline std::filesystem::path whole() {
    return std::filesystem::path(ITEM3D_SHARED_DATA) / "data";
}

/// Returns crops(), and also whole() if it exists.
inline std::vector<std::filesystem::path> folders() {
    if (!std::filesystem::is_directory(whole())) return {crops()};
    return {crops(), whole()};
}

}  // namespace item3d::reference_data
