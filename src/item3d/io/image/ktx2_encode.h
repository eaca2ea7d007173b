// Pictures to KTX2 of Basis Universal. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

namespace item3d {

/// KHR_texture_basisu wants edges that are multiples of four.
bool fits_ktx2(const Image& image);

/// With all mip levels. is_srgb: the values are of colours, sRGB-encoded. is_precise: UASTC, as for
/// normals; else ETC1S of quality 1 to 255. Throws ResourceError where libitem3d_ktx2.so is
/// missing, which holds the encoder, or it fails.
Bytes encode_ktx2(const Image& image, bool is_srgb, bool is_precise, int quality = 192);

}  // namespace item3d
