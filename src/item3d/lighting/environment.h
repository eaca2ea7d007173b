// Environment lights as equirectangular images.
//
// The centre column looks towards -Z, u grows to the right (right quarter +X), v downwards from +Y:
//   u = atan2(d.x, -d.z) / (2 pi) + 0.5,  v = acos(d.y) / pi.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns "studio", "noon", "sunset", "overcast", "night".
const std::vector<std::string>& light_preset_names();

/// Computes a preset: linear RGB radiance, height x 2*height x 3. The skies are physically based
/// (sun and sky by the sun's position); `studio` has soft boxes. Scaled so that the brightest white
/// surface has radiance 1 (sunset 0.7, night 0.15). Throws InputError on other names.
Image make_light_preset(const std::string& name, int height = 256);

/// Turns the light around +Y by `degrees` (positive: from -Z towards +X) and multiplies radiance by
/// 2^exposure.
Image adjust_light(const Image& light, float degrees, float exposure);

Vec3 equirectangular_direction(float u, float v);
Vec2 equirectangular_uv(Vec3 direction);

/// Returns the solid angle in steradians of one texel of row y in an image of height x 2*height.
double texel_solid_angle(int y, int height);

/// Returns irradiance / pi on a surface that faces `normal`: the radiance of a white Lambertian
/// surface.
Vec3 irradiance_over_pi(const Image& light, Vec3 normal);

}  // namespace item3d
