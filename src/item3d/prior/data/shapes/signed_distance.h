// Signed distances of simple solids and their unions, after Quilez's catalogue
// (https://iquilezles.org/articles/distfunctions). A distance is negative inside the solid. Most
// distances are exact. Those of ellipsoids, cones and lathed profiles are bounds, which are close
// to the distance near the surface.
#pragma once

#include "item3d/core/math.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>

namespace item3d {

/// Distance from a point to a surface, negative inside; differentiable almost everywhere.
using SignedDistance = std::function<float(const Vec3&)>;

namespace sdf {

inline float sphere(const Vec3& p, const Vec3& center, float radius) {
    return glm::length(p - center) - radius;
}

inline float ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
    const Vec3 q = (p - center) / radii;
    const float k0 = glm::length(q);
    const float k1 = glm::length(q / radii);
    return k0 * (k0 - 1.0f) / std::max(k1, 1e-4f);
}

/// Rounded segment from a to b, whose radius changes from radius_a to radius_b.
inline float capsule(const Vec3& p, const Vec3& a, const Vec3& b, float radius_a, float radius_b) {
    const Vec3 pa = p - a, ba = b - a;
    const float h = glm::clamp(glm::dot(pa, ba) / glm::dot(ba, ba), 0.0f, 1.0f);
    return glm::length(pa - h * ba) - (radius_a + (radius_b - radius_a) * h);
}
inline float capsule(const Vec3& p, const Vec3& a, const Vec3& b, float radius) {
    return capsule(p, a, b, radius, radius);
}

/// Box with half edges `half`; the edges are rounded by `rounding`.
inline float box(const Vec3& p, const Vec3& center, const Vec3& half, float rounding = 0.0f) {
    const Vec3 q = glm::abs(p - center) - half + rounding;
    const float inside = std::min(std::max(q.x, std::max(q.y, q.z)), 0.0f);
    return glm::length(glm::max(q, Vec3(0.0f))) + inside - rounding;
}

/// Upright cylinder that reaches half_height above and below the centre.
inline float cylinder(const Vec3& p, const Vec3& center, float radius, float half_height,
                      float rounding = 0.02f) {
    const Vec3 q = p - center;
    const Vec2 d(std::hypot(q.x, q.z) - radius + rounding, std::abs(q.y) - half_height + rounding);
    return std::min(std::max(d.x, d.y), 0.0f) + glm::length(glm::max(d, Vec2(0.0f))) - rounding;
}

/// Upright truncated cone around the y axis.
inline float cone(const Vec3& p, float y0, float y1, float radius0, float radius1) {
    const float slope = (radius1 - radius0) / (y1 - y0);
    const float h = glm::clamp((p.y - y0) / (y1 - y0), 0.0f, 1.0f);
    const float side = (std::hypot(p.x, p.z) - (radius0 + (radius1 - radius0) * h)) /
                       std::sqrt(1.0f + slope * slope);
    return std::max(side, std::max(p.y - y1, y0 - p.y));
}

/// Torus. axis: axis of revolution; 0 is x, 1 is y, 2 is z.
inline float torus(const Vec3& p, const Vec3& center, float ring, float tube, int axis = 1) {
    const Vec3 q = p - center;
    const float u = q[(axis + 1) % 3], v = q[(axis + 2) % 3];
    return std::hypot(std::hypot(u, v) - ring, q[axis]) - tube;
}

inline float merge(std::initializer_list<float> parts) {
    return std::min(parts);
}

/// Union with fillets of size k (polynomial smooth minimum).
inline float smooth_merge(float k, std::initializer_list<float> parts) {
    float result = *parts.begin();
    for (const float* part = parts.begin() + 1; part != parts.end(); ++part) {
        const float h = std::max(k - std::abs(result - *part), 0.0f) / k;
        result = std::min(result, *part) - h * h * k * 0.25f;
    }
    return result;
}

/// Mirrors the point at the planes x = 0 and z = 0 as requested, so that one leg makes four.
inline Vec3 fold(Vec3 p, bool x, bool z) {
    if (x) p.x = std::abs(p.x);
    if (z) p.z = std::abs(p.z);
    return p;
}

}  // namespace sdf
}  // namespace item3d
