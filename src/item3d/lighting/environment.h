// Environment lights as equirectangular images.
//
// The centre column looks towards -Z. u grows to the right, where the right quarter looks towards
// +X. v grows downwards from +Y:
//   u = atan2(d.x, -d.z) / (2 pi) + 0.5,  v = acos(d.y) / pi.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <string>
#include <string_view>
#include <vector>

namespace item3d {

struct LightPreset {
    std::string name;
    float peak;                 ///< radiance of the brightest white surface
    Image (*make)(int height);  ///< radiance in any unit, height x 2*height x 3
};

/// Returns all presets.
const std::vector<LightPreset>& light_presets();
std::vector<std::string> light_preset_names();
bool is_light_preset(std::string_view name);
/// Returns the names, separated by commas, for help and messages.
const std::string& light_presets_text();

/// Computes a preset: linear RGB radiance, height x 2*height x 3, scaled to its peak. The skies are
/// physically based: the sun's position determines sun and sky. `studio` has soft boxes. Throws
/// InputError on other names.
Image make_light_preset(const std::string& name, int height = 256);

/// Turns the light around +Y by `degrees` and multiplies radiance by 2^exposure. A positive angle
/// turns -Z towards +X.
Image adjust_light(const Image& light, float degrees, float exposure);

Vec3 equirectangular_direction(float u, float v);
Vec2 equirectangular_uv(Vec3 direction);

/// Returns the solid angle in steradians of one texel of row y in an image of height x 2*height.
double texel_solid_angle(int y, int height);

/// Returns irradiance / pi on a surface that faces `normal`: the radiance of a white Lambertian
/// surface.
Vec3 irradiance_over_pi(const Image& light, Vec3 normal);

}  // namespace item3d
