// Named colours of paint and of metals.
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
/// Returns the 24 plain colours, from "red" to "mustard".
const std::vector<PlainColor>& plain_colors();
/// Returns base colours (normal reflectance) of "gold", "silver", "copper", "bronze", ...
const std::vector<PlainColor>& metal_colors();
/// Returns the middle of metal_roughness_range().
float metal_roughness(const std::string& metal);
/// Returns the roughness range, {lowest, highest}, of a metal in its usual finish.
std::array<float, 2> metal_roughness_range(const std::string& metal);
/// Returns a colour of either list; the name must be in one.
Vec3 color_named(const std::string& name);
/// True if the two named colours are too similar for a pattern.
bool colors_alike(const std::string& first, const std::string& second);

}  // namespace item3d
