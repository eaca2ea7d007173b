#include "item3d/io/image/stb.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_GIF
#define STBI_NO_STDIO
#define STBI_NO_FAILURE_STRINGS
#define STBI_MAX_DIMENSIONS (1 << 16)
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace item3d {
namespace {

/// Size of the blocks that stb_image reads ahead. The file may end within such a block; all other
/// reads request only bytes that the file must contain.
constexpr int stb_buffer_size = 128;

/// The bytes of a file, and how far they were read. stb_image continues with zeros where a file
/// ends early, so the early end is recorded here.
struct StbSource {
    std::span<const std::uint8_t> bytes;
    std::size_t position = 0;
    bool was_short = false;
};

int read_stb(void* user, char* data, int size) {
    auto& source = *static_cast<StbSource*>(user);
    const std::size_t left = source.bytes.size() - source.position;
    const std::size_t needed = size == stb_buffer_size ? 1 : static_cast<std::size_t>(size);
    source.was_short = source.was_short || left < needed;
    const std::size_t count = std::min(left, static_cast<std::size_t>(std::max(size, 0)));
    if (count > 0) std::memcpy(data, source.bytes.data() + source.position, count);
    source.position += count;
    return static_cast<int>(count);
}

void skip_stb(void* user, int count) {
    auto& source = *static_cast<StbSource*>(user);
    if (count < 0) {
        source.position -= std::min(source.position, static_cast<std::size_t>(-(count + 1)) + 1);
    } else {
        source.position =
            std::min(source.bytes.size(), source.position + static_cast<std::size_t>(count));
    }
}

int at_end_of_stb(void* user) {
    const auto& source = *static_cast<StbSource*>(user);
    return source.position == source.bytes.size();
}

constexpr stbi_io_callbacks stb_callbacks{read_stb, skip_stb, at_end_of_stb};

}  // namespace

bool looks_like_tga(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < 18) return false;
    const int map_type = bytes[1];
    const int image_type = bytes[2];
    const int bits = bytes[16];
    const bool has_size = (bytes[12] | bytes[13]) != 0 && (bytes[14] | bytes[15]) != 0;
    // The two highest bits of the descriptor are always 0.
    if (!has_size || map_type > 1 || (bytes[17] & 0xc0) != 0) return false;
    if (image_type == 1 || image_type == 9) {
        const int entry = bytes[7];
        return map_type == 1 && bits == 8 && entry >= 15 && entry <= 32;
    }
    if (image_type == 2 || image_type == 10)
        return bits == 15 || bits == 16 || bits == 24 || bits == 32;
    if (image_type == 3 || image_type == 11) return bits == 8 || bits == 16;
    return false;
}

DecodedImage decode_with_stb(std::span<const std::uint8_t> bytes, const std::string& format,
                             const std::string& subject) {
    const auto fail = [&](const std::string& problem) {
        throw InputError(subject, "the " + format + " cannot be decoded: " + problem,
                         "export it again, for example as PNG");
    };
    int width = 0;
    int height = 0;
    int channels = 0;
    StbSource source{bytes};
    if (!stbi_info_from_callbacks(&stb_callbacks, &source, &width, &height, &channels))
        fail("its header is damaged or of an unknown kind");
    // The limit allows for the compression of GIF and TGA. Most BMP files are uncompressed.
    check_image_size(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 4,
                     bytes.size(), 1ull << 12, subject);
    source = StbSource{bytes};
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_callbacks(&stb_callbacks, &source, &width, &height, &channels, 0),
        &stbi_image_free);
    if (!pixels) fail(source.was_short ? "it ends too early" : "its data are damaged");
    if (source.was_short) fail("it ends too early");
    DecodedImage result{Image(width, height, channels), 8, {}};
    std::transform(pixels.get(), pixels.get() + result.image.pixels.size(),
                   result.image.pixels.begin(),
                   [](stbi_uc value) { return static_cast<float>(value) / 255.0f; });
    return result;
}

}  // namespace item3d
