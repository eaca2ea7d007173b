// What materials.cpp and patterns.cpp share.
#pragma once

#include "item3d/prior/materials.h"

#include <algorithm>
#include <cmath>

namespace item3d::paint {

inline float draw(Random& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}
inline Vec3 mix(const Vec3& a, const Vec3& b, float weight) {
    return a + (b - a) * weight;
}
inline float smooth_step(float x, float low, float high) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}
inline float fraction(float x) {
    return x - std::floor(x);
}
inline Vec3 limit(const Vec3& color) {
    return glm::clamp(color, Vec3(0.0f), Vec3(1.0f));
}

/// A colour somewhat like the given one: brighter or darker, and each channel a little.
inline Vec3 vary(Random& random, const Vec3& color, double spread = .12) {
    const double all = random.normal(0, spread);
    Vec3 result;
    for (int c = 0; c < 3; ++c) {
        result[c] = color[c] * static_cast<float>(std::exp(random.normal(0, spread) * .6 + all));
    }
    return limit(result);
}

Vec3 color_named(const std::string& name);

/// Two different colour names, as wished or at random.
std::pair<std::string, std::string> two_colors(Random& random, const MaterialWish& wish);

/// Coordinates on the plane that the normal faces most: for bricks and other flat patterns.
inline Vec2 flat_coordinates(const Vec3& p, const Vec3& n) {
    const Vec3 a = glm::abs(n);
    if (a.x >= a.y && a.x >= a.z) return Vec2(p.z, p.y);
    if (a.y >= a.z) return Vec2(p.x, p.z);
    return Vec2(p.x, p.y);
}

ProceduralMaterial stripes(Random& random, const MaterialWish& wish);
ProceduralMaterial checks(Random& random, const MaterialWish& wish);
ProceduralMaterial dots(Random& random, const MaterialWish& wish);
ProceduralMaterial zebra(Random& random);
ProceduralMaterial leopard(Random& random);
ProceduralMaterial flames(Random& random);
ProceduralMaterial brick(Random& random);

}  // namespace item3d::paint
