// The interface of libitem3d_ktx2.so: the encoder of Basis Universal, which most edits do not need.
#pragma once

#include <cstdint>
#include <vector>

namespace item3d {

struct Ktx2Image {
    const std::uint8_t* rgba;  ///< [height, width, 4]
    int width;
    int height;
    bool has_alpha;
    bool is_srgb;
    /// True for UASTC with Zstandard; false for ETC1S, which has a fifth of the size and more
    /// error.
    bool is_precise;
    int quality;  ///< for ETC1S, 1 to 255
    int threads;
};

/// Signature of item3d_encode_ktx2. Appends the file, with all its mip levels; returns false on
/// failure.
using Ktx2Encode = bool(const Ktx2Image& image, std::vector<std::uint8_t>& file);
inline constexpr const char* ktx2_encode_name = "item3d_encode_ktx2";

}  // namespace item3d
