// How a picture is encoded in a file.
#pragma once

namespace item3d {

enum class ImageEncoding { png, jpeg, webp };

struct ImageCoding {
    ImageEncoding encoding = ImageEncoding::png;
    /// PNG always, JPEG never.
    bool is_lossless = true;
    /// 1 to 100, of a picture with losses.
    int quality = 95;

    bool operator==(const ImageCoding&) const = default;
};

}  // namespace item3d
