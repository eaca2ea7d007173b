// The encoding of an image in a file.
#pragma once

namespace item3d {

enum class ImageEncoding { png, jpeg, webp, ktx2 };

struct ImageCoding {
    ImageEncoding encoding = ImageEncoding::png;
    /// Always true for PNG, false for JPEG.
    bool is_lossless = true;
    /// Quality from 1 to 100, for lossy images only.
    int quality = 95;
    /// True if the values are sRGB-encoded colours. For KTX2 only.
    bool is_srgb = false;
    /// True for UASTC, false for ETC1S. For KTX2 only.
    bool is_precise = false;

    bool operator==(const ImageCoding&) const = default;
};

}  // namespace item3d
