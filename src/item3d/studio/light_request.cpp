#include "item3d/studio/light_request.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/presets/sky_hour.h"
#include "item3d/lighting/words.h"
#include "item3d/scene/model_view.h"
#include "item3d/studio/halved.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Parses numbers that are separated by commas. Their count must be from `minimum` to `maximum`.
std::vector<float> light_numbers(const std::string& name, const std::string& text,
                                 std::size_t minimum, std::size_t maximum) {
    std::vector<float> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (bool goes_on = true; goes_on;) {
        float value = 0;
        const auto parsed = std::from_chars(at, end, value);
        const bool ends = parsed.ptr == end;
        if (parsed.ec != std::errc() || !std::isfinite(value) || (!ends && *parsed.ptr != ','))
            throw InputError(name, "expected numbers, found '" + text + "'");
        numbers.push_back(value);
        at = parsed.ptr + 1;
        goes_on = !ends;
    }
    if (numbers.size() < minimum || numbers.size() > maximum)
        throw InputError(name, fmt::format("has {} numbers", numbers.size()));
    return numbers;
}

float light_number(const LightParameter& parameter, const char* name, float maximum) {
    const std::string text = parameter(name);
    if (text.empty()) return 0;
    const float value = light_numbers(name, text, 1, 1).front();
    if (std::abs(value) > maximum)
        throw InputError(name, fmt::format("must be within {:g}", maximum));
    return value;
}

std::optional<SunSetting> requested_sun(const LightParameter& parameter) {
    constexpr float highest = 90;
    SunSetting sun;
    if (const std::string text = parameter("sun"); !text.empty()) {
        const std::vector<float> numbers = light_numbers("sun", text, 2, 3);
        if (std::abs(numbers[1]) > highest)
            throw InputError("sun", "its elevation must be from -90 to 90");
        sun.from = {numbers[0], numbers[1]};
        if (numbers.size() == 3 && numbers[2] <= 0)
            throw InputError("sun", "its strength must be above 0");
        if (numbers.size() == 3) sun.strength = numbers[2];
        return sun;
    }
    const std::string words = parameter("lit");
    if (words.empty()) return std::nullopt;
    // Azimuths of cameras are measured from +Z towards +X, azimuths of the compass from -Z towards
    // +X.
    const LightWords read = parse_light_words(words, 180 - default_azimuth * 180 / pi);
    if (!read.from)
        throw InputError("'" + words + "'", "contains no direction of light",
                         "use words such as \"from the left\" or \"low in the east\"");
    sun.from = *read.from;
    return sun;
}

/// Parses "#rrggbb" to linear RGB.
std::optional<Vec3> requested_tint(const std::string& text) {
    constexpr std::size_t length = 7;
    constexpr int hexadecimal = 16;
    if (text.empty()) return std::nullopt;
    Vec3 color(0.0f);
    bool is_color = text.size() == length && text[0] == '#';
    for (int i = 0; is_color && i < 3; ++i) {
        unsigned char value = 0;
        const char* digits = text.data() + 1 + 2 * i;
        is_color = std::from_chars(digits, digits + 2, value, hexadecimal).ptr == digits + 2;
        color[i] = srgb_to_linear(static_cast<float>(value) / 255);
    }
    if (!is_color) throw InputError("tint", "expected #rrggbb, found '" + text + "'");
    return color;
}

Image unchanged_light(const std::string& name, int width, const LightParameter& parameter,
                      const fs::path& file) {
    constexpr float day = 24;
    if (name == "sky") {
        const float hour = light_number(parameter, "hour", day);
        return make_sky_at(hour, width / 2);
    }
    if (is_light_preset(name)) return make_light_preset(name, width / 2);
    if (!fs::exists(file)) throw InputError("light", "no light has this name");
    return halved(load_light(file.string()), width);
}

}  // namespace

Image requested_light(const std::string& name, int width, const LightParameter& parameter,
                      const fs::path& file) {
    constexpr float turns = 36000, stops = 30;
    LightChange change;
    change.rotation = light_number(parameter, "rotate", turns);
    change.tilt = light_number(parameter, "tilt", turns);
    change.exposure = light_number(parameter, "exposure", stops);
    change.sun = requested_sun(parameter);
    change.tint = requested_tint(parameter("tint"));
    return change_light(unchanged_light(name, width, parameter, file), change);
}

}  // namespace item3d
