// How a picture is encoded in a file.
#pragma once

namespace item3d {

enum class ImageEncoding { png, jpeg, webp, ktx2 };

struct ImageCoding {
    ImageEncoding encoding = ImageEncoding::png;
    /// PNG always, JPEG never.
    bool is_lossless = true;
    /// 1 to 100, of a picture with losses.
    int quality = 95;
    /// Of KTX2: colours, rather than other values.
    bool is_srgb = false;
    /// Of KTX2: UASTC, rather than ETC1S.
    bool is_precise = false;

    bool operator==(const ImageCoding&) const = default;
};

}  // namespace item3d
