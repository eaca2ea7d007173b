// The image options of several commands.
#pragma once

#include "item3d/core/error.h"
#include "item3d/core/math.h"
#include "item3d/scene/model_view.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Returns the extension in lower case: ".png" for "a.PNG".
inline std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// True for the extensions of models and images, which are not used for folders.
inline bool is_file_name(const std::string& extension) {
    for (const char* file : {".glb", ".gltf", ".obj", ".vrm", ".jpg", ".jpeg", ".webp", ".hdr",
                             ".png", ".exr", ".html", ".json"})
        if (extension == file) return true;
    return false;
}

struct ImageSize {
    int width = 0;
    int height = 0;
};

/// Maximum image side in pixels.
inline constexpr int largest_side = 16384;

/// Parses "WxH", or one number for a square. Throws UsageError that names `option`.
inline ImageSize parse_size(const std::string& text, const std::string& option = "--size") {
    ImageSize size;
    const char* end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    auto last = width;
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        last = std::from_chars(width.ptr + 1, end, size.height);
    } else {
        size.height = size.width;
    }
    const auto fits = [](int side) { return side >= 1 && side <= largest_side; };
    if (width.ec != std::errc() || last.ec != std::errc() || last.ptr != end || !fits(size.width) ||
        !fits(size.height)) {
        throw UsageError(option + " " + text + ": expected WxH with sides from 1 to " +
                         std::to_string(largest_side) + ", as in 512x512");
    }
    return size;
}

}  // namespace item3d
