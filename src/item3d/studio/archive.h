// Unpacking of an uploaded .zip with a model.
#pragma once

#include <cstdint>
#include <filesystem>

namespace item3d {

struct ArchiveLimits {
    std::int64_t entries = 2000;
    std::int64_t bytes = std::int64_t{1} << 30;  ///< total size of all unpacked files
};

/// Unpacks the files of models (glTF, OBJ, images, buffers) into the folder, under their paths in
/// the archive. Returns the path of the model, which is the .glb, .gltf, .vrm or .obj with the
/// fewest parent folders. If there are several, it is the largest of them. Throws InputError for an
/// archive that is invalid, encrypted or beyond the limits, that has a path outside of the folder,
/// or that has no model. Throws ResourceError for a full disk. After an error, the files that are
/// already unpacked stay.
std::filesystem::path unpack_model(const std::filesystem::path& archive,
                                   const std::filesystem::path& folder,
                                   const ArchiveLimits& limits = {});

}  // namespace item3d
