#include "item3d/io/image/decoded_image.h"

#include "item3d/core/error.h"

#include <fmt/format.h>

namespace item3d {

void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                      std::uint64_t available, std::uint64_t max_pixels_per_byte,
                      const std::string& subject) {
    constexpr std::uint64_t max_values = 1ull << 28;
    if (width == 0 || height == 0 || channels == 0) {
        throw InputError(subject, fmt::format("declares {} x {} pixels", width, height),
                         "export the image again");
    }
    if (width > max_values || height > max_values || width * height > max_values / channels) {
        throw InputError(subject,
                         fmt::format("declares {} x {} pixels, which is too large", width, height),
                         "scale it down");
    }
    if (width * height > (available + 64) * max_pixels_per_byte) {
        throw InputError(subject,
                         fmt::format("declares {} x {} pixels, but {} bytes are too few for them",
                                     width, height, available),
                         "the file is damaged; save it again");
    }
}

}  // namespace item3d
