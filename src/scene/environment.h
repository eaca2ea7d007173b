// Light from all around, as equirectangular images.
//
// The centre column looks towards -Z, u grows to the right (right quarter +X), v downwards from +Y:
//   u = atan2(d.x, -d.z) / (2 pi) + 0.5,  v = acos(d.y) / pi.
#pragma once

#include <string>
#include <vector>

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

/// "studio", "noon", "sunset", "overcast", "night".
const std::vector<std::string>& light_preset_names();

/// Computes a preset: linear RGB radiance, height x 2*height x 3. The skies are physically based
/// (sun and sky by position of the sun), `studio` has soft boxes. Throws InputError on other names.
Image make_light_preset(const std::string& name, int height = 256);

/// A preset by name, or an .hdr/.exr file. Throws InputError.
Image load_light(const std::string& name_or_path);

/// Turns the light around +Y by `degrees` (positive: what stood at -Z moves towards +X) and
/// multiplies radiance by 2^exposure.
Image adjust_light(const Image& light, float degrees, float exposure);

Vec3 equirectangular_direction(float u, float v);
Vec2 equirectangular_uv(Vec3 direction);

}  // namespace item3d
