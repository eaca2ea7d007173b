// The model in a .zip that somebody uploaded.
#pragma once

#include <cstdint>
#include <filesystem>

namespace item3d {

struct ArchiveLimits {
    std::int64_t entries = 2000;
    std::int64_t bytes = std::int64_t{1} << 30;  ///< of all files, unpacked
};

/// Unpacks what models are made of (glTF, OBJ, pictures, buffers) into the folder, by the archive's
/// own paths, and returns the model among it: the .glb, .gltf, .vrm or .obj nearest to the top, the
/// largest of several. Throws InputError for what is no archive, is encrypted or beyond the limits,
/// names a place outside of the folder, or has no model; ResourceError for a full disk. What was
/// unpacked by then stays.
std::filesystem::path unpack_model(const std::filesystem::path& archive,
                                   const std::filesystem::path& folder,
                                   const ArchiveLimits& limits = {});

}  // namespace item3d
