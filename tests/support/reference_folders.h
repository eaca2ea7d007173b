// Folders of data that other software made.
#pragma once

#include <filesystem>
#include <vector>

namespace item3d::reference_data {

/// Returns the repository's own: crops of large files, and small files as they are.
inline std::filesystem::path crops() {
    return std::filesystem::path(ITEM3D_TEST_DATA) / "references";
}

/// Returns the place of the whole data, beside the repository, where few machines have it.
inline std::filesystem::path whole() {
    return std::filesystem::path(ITEM3D_SHARED_DATA) / "data";
}

/// Returns crops(), and whole() where it exists.
inline std::vector<std::filesystem::path> folders() {
    if (!std::filesystem::is_directory(whole())) return {crops()};
    return {crops(), whole()};
}

}  // namespace item3d::reference_data
