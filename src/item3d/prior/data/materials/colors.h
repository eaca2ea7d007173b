// The colours that have names, of paint and of metals.
#pragma once

#include "item3d/core/math.h"

#include <array>
#include <string>
#include <vector>

namespace item3d {

struct PlainColor {
    std::string name;
    Vec3 linear;  ///< base colour, linear RGB
};
/// The 24 plain colours: "red" ... "mustard".
const std::vector<PlainColor>& plain_colors();
/// Base colours (normal reflectance) of "gold", "silver", "copper", "bronze", ...
const std::vector<PlainColor>& metal_colors();
/// The middle of the roughness that a metal of this name is drawn with in its usual finish.
float metal_roughness(const std::string& metal);
/// The range it is drawn from, lowest and highest.
std::array<float, 2> metal_roughness_range(const std::string& metal);
/// Of either list; the name must be there.
Vec3 color_named(const std::string& name);
/// Whether two of those names look too much the same to make a pattern.
bool colors_alike(const std::string& first, const std::string& second);

}  // namespace item3d
