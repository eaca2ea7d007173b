#include "item3d/field/atlas/uv_raster.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t subtexels = 256;
/// Magnitude of a UV beyond which floats cannot resolve texels.
constexpr float farthest_uv = 4096.0f;
/// Largest number of repetitions of the texture, along one axis, that are sampled for a triangle.
constexpr std::int64_t max_tiles = 6;
/// Smallest bilinear weight at which a texel belongs to a triangle smaller than a texel.
constexpr float min_weight = 1.0f / 64;

struct Point {
    std::int64_t x, y;
};

std::int64_t edge(Point a, Point b, Point p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Returns 0 if the points on the edge belong to the triangle, otherwise -1. The two triangles at
/// an edge traverse it in opposite directions, so its points belong to exactly one of them.
std::int64_t edge_bias(Point a, Point b) {
    const bool owns = b.y > a.y || (b.y == a.y && b.x < a.x);
    return owns ? 0 : -1;
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

bool is_odd(int tile) {
    return (tile & 1) != 0;
}

struct WrappedTexel {
    int texel, tile;
};

WrappedTexel wrap_texel(std::int64_t texel, int count, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge)
        return {static_cast<int>(std::clamp<std::int64_t>(texel, 0, count - 1)), 0};
    const auto tile = static_cast<int>(floor_divide(texel, count));
    const int inside = static_cast<int>(texel - std::int64_t{tile} * count);
    const bool reversed = wrap == Wrap::mirrored_repeat && is_odd(tile);
    return {reversed ? count - 1 - inside : inside, tile};
}

/// The texels [first, last] of a triangle's bounding box along an axis. If the triangle repeats the
/// texture many times, they are only the texels around its middle.
struct Span {
    std::int64_t first, last;

    Span(std::int64_t low, std::int64_t high, std::int64_t middle, int count)
        : first(floor_divide(low, subtexels)), last(floor_divide(high, subtexels)) {
        if (last - first <= max_tiles * count) return;
        const std::int64_t center = floor_divide(middle, subtexels);
        first = center - count;
        last = center + count;
    }
};

bool is_usable(const UvTriangle& triangle) {
    return std::all_of(triangle.begin(), triangle.end(), [](Vec2 uv) {  // false for NaN
        return std::abs(uv.x) < farthest_uv && std::abs(uv.y) < farthest_uv;
    });
}

}  // namespace

float unwrap_coordinate(float folded, int tile, Wrap wrap) {
    if (wrap == Wrap::mirrored_repeat && is_odd(tile)) folded = 1.0f - folded;
    return folded + static_cast<float>(tile);
}

float wrap_coordinate(float coordinate, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return std::clamp(coordinate, 0.0f, 1.0f);
    const float tile = std::floor(coordinate);
    const float inside = coordinate - tile;
    return wrap == Wrap::mirrored_repeat && is_odd(static_cast<int>(tile)) ? 1.0f - inside : inside;
}

Vec2 UvRaster::uv_at(int x, int y) const {
    const UvOwner& here = owner(x, y);
    return {unwrap_coordinate((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                              here.tile_u, wrap.u),
            unwrap_coordinate((static_cast<float>(y) + 0.5f) / static_cast<float>(height),
                              here.tile_v, wrap.v)};
}

UvRaster rasterize_uv(std::span<const UvTriangle> triangles, int width, int height, UvWrap wrap,
                      const OverlapFunction& on_overlap) {
    UvRaster raster;
    raster.width = width;
    raster.height = height;
    raster.wrap = wrap;
    raster.owners.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                         UvOwner());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!is_usable(triangles[t])) continue;
        Point p[3];
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec2 uv = triangles[t][c];
            p[c] = {std::llround(static_cast<double>(uv.x) * width * subtexels),
                    std::llround(static_cast<double>(uv.y) * height * subtexels)};
        }
        const std::int64_t area = edge(p[0], p[1], p[2]);
        if (area == 0) continue;
        if (area < 0) std::swap(p[1], p[2]);
        const std::int64_t bias[3] = {edge_bias(p[0], p[1]), edge_bias(p[1], p[2]),
                                      edge_bias(p[2], p[0])};
        const auto [low_x, high_x] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [low_y, high_y] = std::minmax({p[0].y, p[1].y, p[2].y});
        const Span across(low_x, high_x, (p[0].x + p[1].x + p[2].x) / 3, width);
        const Span down(low_y, high_y, (p[0].y + p[1].y + p[2].y) / 3, height);
        for (std::int64_t y = down.first; y <= down.last; ++y) {
            const WrappedTexel row = wrap_texel(y, height, wrap.v);
            for (std::int64_t x = across.first; x <= across.last; ++x) {
                const Point center{x * subtexels + subtexels / 2, y * subtexels + subtexels / 2};
                if (edge(p[0], p[1], center) + bias[0] < 0) continue;
                if (edge(p[1], p[2], center) + bias[1] < 0) continue;
                if (edge(p[2], p[0], center) + bias[2] < 0) continue;
                const WrappedTexel column = wrap_texel(x, width, wrap.u);
                const std::size_t texel =
                    static_cast<std::size_t>(row.texel) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column.texel);
                const UvOwner covers{static_cast<std::int32_t>(t),
                                     static_cast<std::int16_t>(column.tile),
                                     static_cast<std::int16_t>(row.tile)};
                if (raster.owners[texel].triangle < 0) {
                    raster.owners[texel] = covers;
                } else if (on_overlap && !on_overlap(texel, raster.owners[texel], covers)) {
                    return raster;
                }
            }
        }
    }
    return raster;
}

void claim_texels(UvRaster& raster, std::span<const UvTriangle> triangles) {
    std::vector<bool> has_texels(triangles.size(), false);
    for (const UvOwner& owner : raster.owners)
        if (owner.triangle >= 0) has_texels[static_cast<std::size_t>(owner.triangle)] = true;
    const auto edge_of = [](const UvTriangle& t, bool vertical) {
        const auto [low, high] = vertical ? std::minmax({t[0].y, t[1].y, t[2].y})
                                          : std::minmax({t[0].x, t[1].x, t[2].x});
        return high - low;
    };
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const UvTriangle& triangle = triangles[t];
        if (has_texels[t] || !is_usable(triangle)) continue;
        if (edge_of(triangle, false) * static_cast<float>(raster.width) > 2.0f ||
            edge_of(triangle, true) * static_cast<float>(raster.height) > 2.0f)
            continue;  // other triangles cover its texels
        const Vec2 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0f;
        const float x = middle.x * static_cast<float>(raster.width) - 0.5f;
        const float y = middle.y * static_cast<float>(raster.height) - 0.5f;
        for (int corner = 0; corner < 4; ++corner) {
            const auto texel_x = static_cast<std::int64_t>(std::floor(x)) + corner % 2;
            const auto texel_y = static_cast<std::int64_t>(std::floor(y)) + corner / 2;
            const float weight = (1.0f - std::abs(x - static_cast<float>(texel_x))) *
                                 (1.0f - std::abs(y - static_cast<float>(texel_y)));
            if (weight < min_weight) continue;
            const WrappedTexel column = wrap_texel(texel_x, raster.width, raster.wrap.u);
            const WrappedTexel row = wrap_texel(texel_y, raster.height, raster.wrap.v);
            UvOwner& owner = raster.owners[static_cast<std::size_t>(row.texel) *
                                               static_cast<std::size_t>(raster.width) +
                                           static_cast<std::size_t>(column.texel)];
            if (owner.triangle >= 0) continue;
            owner = {static_cast<std::int32_t>(t), static_cast<std::int16_t>(column.tile),
                     static_cast<std::int16_t>(row.tile)};
        }
    }
}

void widen(UvRaster& raster) {
    const std::vector<UvOwner> before = raster.owners;
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) +
               static_cast<std::size_t>(x);
    };
    for (int y = 0; y < raster.height; ++y) {
        for (int x = 0; x < raster.width; ++x) {
            if (before[at(x, y)].triangle >= 0) continue;
            for (int ny = std::max(0, y - 1); ny <= std::min(raster.height - 1, y + 1); ++ny) {
                for (int nx = std::max(0, x - 1); nx <= std::min(raster.width - 1, x + 1); ++nx)
                    if (before[at(nx, ny)].triangle >= 0)
                        raster.owners[at(x, y)] = before[at(nx, ny)];
            }
        }
    }
}

Vec2 uv_barycentrics(const UvTriangle& triangle, Vec2 uv) {
    const auto cross = [](Vec2 a, Vec2 b) {
        return static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
    };
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
