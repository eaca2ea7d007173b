#include "item3d/studio/light_query.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/words.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace item3d {
namespace {

/// Of the default camera of `item3d render`, as the compass counts.
constexpr float viewer_azimuth = 145;

std::vector<float> query_numbers(const std::string& name, const std::string& text,
                                 std::size_t least, std::size_t most) {
    std::vector<float> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at != end) {
        float value = 0;
        const auto [next, failure] = std::from_chars(at, end, value);
        if (failure != std::errc() || !std::isfinite(value)) break;
        numbers.push_back(value);
        at = next;
        if (at != end && *at == ',' && at + 1 != end)
            ++at;
        else
            break;
    }
    if (at != end || numbers.size() < least || numbers.size() > most)
        throw InputError(name, fmt::format("'{}' is no number that it can be", text));
    return numbers;
}

float query_number(const std::string& name, const std::string& text, float low, float high) {
    if (text.empty()) return 0;
    const float value = query_numbers(name, text, 1, 1).front();
    if (value < low || value > high)
        throw InputError(name, fmt::format("{} is not between {} and {}", value, low, high));
    return value;
}

SunSetting sun_of(const LightQuery& query) {
    SunSetting sun;
    if (!query.lit.empty()) {
        const LightWords words = parse_light_words(query.lit, viewer_azimuth);
        if (!words.from)
            throw InputError("'" + query.lit + "'", "names no direction of light",
                             fmt::format("{}", fmt::join(light_words_help(), "; ")));
        sun.from = *words.from;
        return sun;
    }
    const std::vector<float> numbers = query_numbers("sun", query.sun, 2, 3);
    if (std::abs(numbers[1]) > 90)
        throw InputError("sun", "its elevation is not between -90 and 90");
    sun.from = {numbers[0], numbers[1]};
    if (numbers.size() == 3) {
        if (!(numbers[2] > 0)) throw InputError("sun", "its strength is not above 0");
        sun.strength = numbers[2];
    }
    return sun;
}

/// Linear, of "#rrggbb".
Vec3 tint_of(const std::string& text) {
    std::uint32_t value = 0;
    const char* const end = text.data() + text.size();
    if (text.size() != 7 || text[0] != '#' ||
        std::from_chars(text.data() + 1, end, value, 16).ptr != end)
        throw InputError("tint", "'" + text + "' is no colour like #ffd9b0");
    const auto channel = [&](int shift) {
        return srgb_to_linear(static_cast<float>(value >> shift & 0xff) / 255.0f);
    };
    return {channel(16), channel(8), channel(0)};
}

}  // namespace

bool LightQuery::changes() const {
    return hour || rotate != 0 || tilt != 0 || exposure != 0 || !sun.empty() || !lit.empty() ||
           !tint.empty();
}

LightQuery parse_light_query(const std::function<std::string(const std::string&)>& parameter) {
    LightQuery query;
    if (const std::string hour = parameter("hour"); !hour.empty())
        query.hour = query_number("hour", hour, 0, 24);
    query.rotate = query_number("rotate", parameter("rotate"), -36000, 36000);
    query.tilt = query_number("tilt", parameter("tilt"), -36000, 36000);
    query.exposure = query_number("exposure", parameter("exposure"), -30, 30);
    query.sun = parameter("sun");
    query.lit = parameter("lit");
    query.tint = parameter("tint");
    return query;
}

Image changed_light(const Image& light, const LightQuery& query) {
    Image result = light;
    if (query.rotate != 0) result = adjust_light(result, query.rotate, 0);
    if (query.tilt != 0) result = tilt_light(result, query.tilt);
    if (!query.sun.empty() || !query.lit.empty()) result = place_sun(result, sun_of(query));
    if (!query.tint.empty()) result = tint_light(result, tint_of(query.tint));
    if (query.exposure != 0) result = adjust_light(result, 0, query.exposure);
    return result;
}

}  // namespace item3d
