#include "item3d/core/data_uri.h"

#include <algorithm>
#include <string_view>

namespace item3d {
namespace {

bool starts_with(const Bytes& bytes, std::string_view magic, std::size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

std::string media_type(const Bytes& bytes) {
    if (starts_with(bytes, "\x89PNG")) return "image/png";
    if (starts_with(bytes, "\xff\xd8\xff")) return "image/jpeg";
    if (starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8)) return "image/webp";
    if (starts_with(bytes, "GIF8")) return "image/gif";
    return "application/octet-stream";
}

std::string base64(const Bytes& bytes) {
    static constexpr std::string_view alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const unsigned group =
            bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
        text += alphabet[group >> 18 & 63];
        text += alphabet[group >> 12 & 63];
        text += left > 1 ? alphabet[group >> 6 & 63] : '=';
        text += left > 2 ? alphabet[group & 63] : '=';
    }
    return text;
}

}  // namespace

std::string data_uri(const Bytes& bytes) {
    return "data:" + media_type(bytes) + ";base64," + base64(bytes);
}

}  // namespace item3d
