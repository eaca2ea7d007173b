// Encoding of images to KTX2 of Basis Universal. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

namespace item3d {

/// True if the edges are multiples of four, as KHR_texture_basisu requires.
bool fits_ktx2(const Image& image);

/// Encodes with all mip levels. is_srgb: the values are sRGB-encoded colours. is_precise: the
/// encoding is UASTC, as for normals, instead of ETC1S. quality: 1 to 255, for ETC1S only. Throws
/// ResourceError if the encoder fails, or if its library, libitem3d_ktx2.so, is missing.
Bytes encode_ktx2(const Image& image, bool is_srgb, bool is_precise, int quality = 192);

}  // namespace item3d
