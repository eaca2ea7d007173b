// Colours as people name and compare them.
#pragma once

#include "item3d/core/math.h"

#include <span>
#include <string>
#include <vector>

namespace item3d {

/// CIELAB under D65: L in [0, 100], a and b about [-100, 100].
struct Lab {
    double l = 0;
    double a = 0;
    double b = 0;
};

/// Linear Rec.709 RGB to CIELAB (CIE 15:2004, sRGB primaries, white D65).
Lab linear_to_lab(Vec3 linear);
Lab srgb_to_lab(Vec3 encoded);

/// CIE 1976 colour difference: Euclidean distance in CIELAB. 2.3 is just noticeable.
double color_difference(const Lab& a, const Lab& b);

struct NamedColor {
    std::string name;
    Vec3 srgb;  ///< encoded, [0, 1]
};

/// Index of the colour nearest to `linear` in CIELAB; the first of equals. `colors` is not empty.
std::size_t nearest_color(Vec3 linear, std::span<const NamedColor> colors);

/// The eleven basic colour terms of English (Berlin and Kay 1969) and what users of a render
/// command write besides them.
const std::vector<NamedColor>& basic_colors();

/// A name of basic_colors, "#rgb", "#rrggbb", or "r,g,b" with numbers in [0, 1] (encoded, as the
/// others). Returns sRGB-encoded values. Throws InputError.
Vec3 parse_color(const std::string& text);

}  // namespace item3d
