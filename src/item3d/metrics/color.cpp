#include "item3d/metrics/color.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace item3d {

namespace {

double lab_curve(double t) {
    constexpr double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
}

std::optional<Vec3> parse_hexadecimal(const std::string& digits) {
    if (digits.size() != 3 && digits.size() != 6) return std::nullopt;
    unsigned value = 0;
    const char* end = digits.data() + digits.size();
    const auto parsed = std::from_chars(digits.data(), end, value, 16);
    if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
    const int bits = digits.size() == 3 ? 4 : 8;
    const unsigned mask = (1u << bits) - 1;
    return Vec3((value >> (2 * bits)) & mask, (value >> bits) & mask, value & mask) /
           static_cast<float>(mask);
}

std::optional<Vec3> parse_numbers(const std::string& text) {
    Vec3 color(0);
    const char* at = text.data();
    const char* end = at + text.size();
    for (int c = 0; c < 3; ++c) {
        if (c > 0) {
            if (at == end || *at != ',') return std::nullopt;
            ++at;
        }
        while (at != end && *at == ' ')
            ++at;
        const auto parsed = std::from_chars(at, end, color[c]);
        if (parsed.ec != std::errc() || !(color[c] >= 0 && color[c] <= 1)) return std::nullopt;
        at = parsed.ptr;
    }
    return at == end ? std::optional<Vec3>(color) : std::nullopt;
}

}  // namespace

Lab linear_to_lab(Vec3 linear) {
    const double r = linear.x;
    const double g = linear.y;
    const double b = linear.z;
    // White is (1, 1, 1): each row is divided by its sum, the white point's X, Y or Z.
    const double x = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.9504700;
    const double y = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
    const double z = (0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.0888300;
    const double fx = lab_curve(x);
    const double fy = lab_curve(y);
    const double fz = lab_curve(z);
    return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

Lab srgb_to_lab(Vec3 encoded) {
    return linear_to_lab(
        Vec3(srgb_to_linear(encoded.x), srgb_to_linear(encoded.y), srgb_to_linear(encoded.z)));
}

double color_difference(const Lab& a, const Lab& b) {
    return std::sqrt((a.l - b.l) * (a.l - b.l) + (a.a - b.a) * (a.a - b.a) +
                     (a.b - b.b) * (a.b - b.b));
}

std::size_t nearest_color(Vec3 linear, std::span<const NamedColor> colors) {
    ITEM3D_CHECK(!colors.empty(), "no colours to choose from");
    const Lab wanted = linear_to_lab(linear);
    const auto nearest = std::min_element(colors.begin(), colors.end(),
                                          [&](const NamedColor& a, const NamedColor& b) {
                                              return color_difference(wanted, srgb_to_lab(a.srgb)) <
                                                     color_difference(wanted, srgb_to_lab(b.srgb));
                                          });
    return static_cast<std::size_t>(nearest - colors.begin());
}

const std::vector<NamedColor>& basic_colors() {
    static const std::vector<NamedColor> colors = {
        {"black", Vec3(0.05f)},
        {"white", Vec3(0.95f)},
        {"gray", Vec3(0.50f)},
        {"red", Vec3(0.78f, 0.09f, 0.08f)},
        {"green", Vec3(0.10f, 0.55f, 0.16f)},
        {"blue", Vec3(0.09f, 0.20f, 0.75f)},
        {"yellow", Vec3(0.95f, 0.82f, 0.10f)},
        {"orange", Vec3(0.95f, 0.48f, 0.06f)},
        {"purple", Vec3(0.45f, 0.12f, 0.60f)},
        {"pink", Vec3(0.95f, 0.55f, 0.70f)},
        {"brown", Vec3(0.40f, 0.24f, 0.12f)},
    };
    return colors;
}

Vec3 parse_color(const std::string& text) {
    // "black" and "white" are pure here, as backgrounds need them. The basic colours of these names
    // are not.
    if (text == "black") return Vec3(0);
    if (text == "white") return Vec3(1);
    const std::string name = text == "grey" ? "gray" : text;
    for (const NamedColor& color : basic_colors()) {
        if (color.name == name) return color.srgb;
    }
    const std::optional<Vec3> color =
        text.starts_with('#') ? parse_hexadecimal(text.substr(1)) : parse_numbers(text);
    if (color) return *color;
    std::string names;
    for (const NamedColor& known : basic_colors()) {
        names += (names.empty() ? "" : ", ") + known.name;
    }
    throw InputError(
        "colour '" + text + "'", "is not a colour",
        fmt::format("use one of {}, #rrggbb, or three numbers r,g,b in [0, 1]", names));
}

}  // namespace item3d
