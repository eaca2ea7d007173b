// Unpacking of an uploaded .zip with a model.
#pragma once

#include <cstdint>
#include <filesystem>

namespace item3d {

struct ArchiveLimits {
    std::int64_t entries = 2000;
    std::int64_t bytes = std::int64_t{1} << 30;  ///< total of all files, unpacked
};

/// Unpacks the files of models (glTF, OBJ, images, buffers) into the folder, under their paths in
/// the archive. Returns the path of the model: the .glb, .gltf, .vrm or .obj with the fewest parent
/// folders, and of several such files the largest. Throws InputError for an archive that is
/// invalid, encrypted or beyond the limits, that has a path outside of the folder, or that has no
/// model; ResourceError for a full disk. After an error, the files that are already unpacked stay.
std::filesystem::path unpack_model(const std::filesystem::path& archive,
                                   const std::filesystem::path& folder,
                                   const ArchiveLimits& limits = {});

}  // namespace item3d
