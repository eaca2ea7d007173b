#include "item3d/io/load_light.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/image_light.h"
#include "item3d/io/image/formats.h"
#include "item3d/lighting/environment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string>

namespace item3d {

namespace {

namespace fs = std::filesystem;

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// Reads an image as linear RGB. A file with one or two channels gives three equal ones.
Image read_light_image(const std::string& path) {
    const Bytes bytes = read_bytes(path);
    const Image source = decode_image(bytes, path).image;
    const ImageFormat format = detect_image_format(bytes);
    const bool is_encoded = format != ImageFormat::radiance && format != ImageFormat::openexr;
    if (is_encoded) {
        warn(path +
             ": is not an HDR image; it is read as sRGB, in which white is radiance 1, so a sun is "
             "too weak");
    }
    Image light(source.width, source.height, 3);
    for (int y = 0; y < light.height; ++y) {
        for (int x = 0; x < light.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const float value = source.at(x, y, source.channels >= 3 ? c : 0);
                light.at(x, y, c) = is_encoded ? srgb_to_linear(value) : value;
            }
        }
    }
    return light;
}

/// Largest radiance of a light. Its sums over a sphere stay far below float32's maximum.
constexpr float max_radiance = 1e12f;

/// Returns the replacement of infinite values: at least 65504, the maximum of half floats, because
/// brighter suns are infinite in half floats.
float sun_radiance(const Image& light) {
    float largest = 65504.0f;
    for (const float value : light.pixels) {
        if (value <= max_radiance) largest = std::max(largest, value);
    }
    return largest;
}

/// Throws InputError for an unusable light; warns of values that are replaced.
void make_usable(Image& light, const std::string& path) {
    std::size_t negative = 0, unbounded = 0, undefined = 0;
    bool is_black = true;
    const float sun = sun_radiance(light);
    for (float& value : light.pixels) {
        undefined += std::isnan(value) ? 1 : 0;
        unbounded += value > max_radiance ? 1 : 0;
        negative += value < 0 ? 1 : 0;
        if (value > max_radiance) value = sun;
        value = value > 0 ? value : 0.0f;  // also false for NaN
        is_black = is_black && value == 0;
    }
    if (undefined > light.pixels.size() / 2) {
        throw InputError(
            path, fmt::format("{} of {} values are not numbers", undefined, light.pixels.size()),
            "render or export it again");
    }
    if (is_black) {
        throw InputError(path, negative > 0 ? "has no value above 0" : "is completely black",
                         "use another light or a preset");
    }
    if (unbounded > 0) {
        warn(
            fmt::format("{}: {} values are infinite or above {:g} and are clamped to {:g}; a sun "
                        "may be too weak",
                        path, unbounded, max_radiance, sun));
    }
    if (undefined > 0) {
        warn(fmt::format("{}: {} values are not numbers and are set to 0", path, undefined));
    }
    if (negative > 0) warn(fmt::format("{}: {} negative values are set to 0", path, negative));
}

}  // namespace

Image load_light(const std::string& name_or_path, LightLayout layout) {
    if (is_light_preset(name_or_path)) return make_light_preset(name_or_path);
    std::error_code ignored;
    if (!fs::exists(name_or_path, ignored)) {
        throw InputError("light '" + name_or_path + "'", "neither a preset nor an existing file",
                         "use " + light_presets_text() + ", or an .hdr or .exr file");
    }
    const std::string extension = extension_of(name_or_path);
    if (extension == ".glb" || extension == ".gltf") return load_image_based_light(name_or_path);
    Image light = read_light_image(name_or_path);
    if (light.width < 2 || light.height < 2) {
        throw InputError(
            name_or_path,
            fmt::format("an image of {}x{} is not an environment map", light.width, light.height),
            "use an image of all directions, or a preset");
    }
    make_usable(light, name_or_path);
    return to_equirectangular(light, layout, name_or_path);
}

}  // namespace item3d
