// Unpacking of an uploaded .zip with a model.
#pragma once

#include <cstdint>
#include <filesystem>

namespace item3d {

struct ArchiveLimits {
    std::int64_t entries = 2000;
    std::int64_t bytes = std::int64_t{1} << 30;  ///< total of all files, unpacked
};

/// Unpacks the files of models (glTF, OBJ, images, buffers) into the folder, by the archive's own
/// paths. Returns the model: the .glb, .gltf, .vrm or .obj nearest to the top, the largest of
/// several. Throws InputError for an invalid or encrypted archive, one beyond the limits, with a
/// path outside of the folder, or without a model; ResourceError for a full disk. Files unpacked by
/// then stay.
std::filesystem::path unpack_model(const std::filesystem::path& archive,
                                   const std::filesystem::path& folder,
                                   const ArchiveLimits& limits = {});

}  // namespace item3d
