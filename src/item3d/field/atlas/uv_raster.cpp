#include "item3d/field/atlas/uv_raster.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t subtexels = 256;
/// UVs' rounding may move a triangle this far off a texel's centre; less than half a texel of the
/// largest picture.
constexpr float snapping = 5e-5f;

struct Point {
    std::int64_t x, y;
};

std::int64_t edge(Point a, Point b, Point p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// 0 for edges whose own points belong to the triangle, -1 for the others: of two triangles at an
/// edge, which run along it in opposite directions, one has it.
std::int64_t edge_bias(Point a, Point b) {
    const bool owns = b.y > a.y || (b.y == a.y && b.x < a.x);
    return owns ? 0 : -1;
}

int wrap(int texel, int count) {
    const int rest = texel % count;
    return rest < 0 ? rest + count : rest;
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

}  // namespace

UvRaster rasterize_uv(std::span<const UvTriangle> triangles, int width, int height,
                      const OverlapFunction& on_overlap) {
    UvRaster raster;
    raster.width = width;
    raster.height = height;
    raster.triangle.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Point p[3];
        bool usable = true;
        for (int c = 0; c < 3; ++c) {
            const Vec2 uv = triangles[t][static_cast<std::size_t>(c)];
            usable = usable && std::abs(uv.x) < 64.0f && std::abs(uv.y) < 64.0f;  // NaN: false
            if (!usable) break;
            p[c] = {std::llround(static_cast<double>(uv.x) * width * subtexels),
                    std::llround(static_cast<double>(uv.y) * height * subtexels)};
        }
        if (!usable) continue;
        const std::int64_t area = edge(p[0], p[1], p[2]);
        if (area == 0) continue;
        if (area < 0) std::swap(p[1], p[2]);
        const std::int64_t bias[3] = {edge_bias(p[0], p[1]), edge_bias(p[1], p[2]),
                                      edge_bias(p[2], p[0])};
        const auto [low_x, high_x] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [low_y, high_y] = std::minmax({p[0].y, p[1].y, p[2].y});
        if (high_x - low_x > (width + 1) * subtexels || high_y - low_y > (height + 1) * subtexels) {
            continue;
        }
        const auto texel_at = [](std::int64_t position) {
            return static_cast<int>(floor_divide(position, subtexels));
        };
        for (int y = texel_at(low_y); y <= texel_at(high_y); ++y) {
            for (int x = texel_at(low_x); x <= texel_at(high_x); ++x) {
                const Point center{x * subtexels + subtexels / 2, y * subtexels + subtexels / 2};
                if (edge(p[0], p[1], center) + bias[0] < 0) continue;
                if (edge(p[1], p[2], center) + bias[1] < 0) continue;
                if (edge(p[2], p[0], center) + bias[2] < 0) continue;
                const std::size_t texel =
                    static_cast<std::size_t>(wrap(y, height)) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(wrap(x, width));
                if (raster.triangle[texel] < 0) {
                    raster.triangle[texel] = static_cast<std::int32_t>(t);
                } else if (on_overlap && !on_overlap(texel, raster.triangle[texel],
                                                     static_cast<std::int32_t>(t))) {
                    return raster;
                }
            }
        }
    }
    return raster;
}

Vec2 uv_barycentrics(const UvTriangle& triangle, Vec2 uv) {
    const auto cross = [](Vec2 a, Vec2 b) {
        return static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
    };
    // The repetition of the texel that lies in the triangle's box.
    const Vec2 low = glm::min(triangle[0], glm::min(triangle[1], triangle[2]));
    uv += glm::ceil(low - Vec2(snapping) - uv);
    const Vec2 a = triangle[0] - triangle[2];
    const Vec2 b = triangle[1] - triangle[2];
    const Vec2 p = uv - triangle[2];
    const double area = cross(a, b);
    if (area == 0.0) return Vec2(1.0f / 3.0f);
    double u = std::max(0.0, cross(p, b) / area);
    double v = std::max(0.0, cross(a, p) / area);
    const double sum = u + v;
    if (sum > 1.0) u /= sum, v /= sum;
    return Vec2(static_cast<float>(u), static_cast<float>(v));
}

}  // namespace item3d
