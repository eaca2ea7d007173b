// Colours: CIELAB, colour differences and colour names.
#pragma once

#include "item3d/core/math.h"

#include <span>
#include <string>
#include <vector>

namespace item3d {

/// CIELAB colour under D65: L in [0, 100], a and b about [-100, 100].
struct Lab {
    double l = 0;
    double a = 0;
    double b = 0;
};

/// Converts linear Rec.709 RGB to CIELAB (CIE 15:2004, sRGB primaries, white D65).
Lab linear_to_lab(Vec3 linear);
Lab srgb_to_lab(Vec3 encoded);

/// Returns the CIE 1976 colour difference: the Euclidean distance in CIELAB. A difference of 2.3 is
/// just noticeable.
double color_difference(const Lab& a, const Lab& b);

struct NamedColor {
    std::string name;
    Vec3 srgb;  ///< encoded, [0, 1]
};

/// Returns the index of the colour nearest to `linear` in CIELAB; of several nearest ones, the
/// first. `colors` must not be empty.
std::size_t nearest_color(Vec3 linear, std::span<const NamedColor> colors);

/// Returns the eleven basic colour terms of English (Berlin and Kay 1969) and other names that
/// users type.
const std::vector<NamedColor>& basic_colors();

/// Parses a name of basic_colors, "#rgb", "#rrggbb", or "r,g,b" with sRGB-encoded numbers in [0,
/// 1]. Returns sRGB-encoded values. Throws InputError.
Vec3 parse_color(const std::string& text);

}  // namespace item3d
