// Which triangle of an atlas covers which texel. No torch here.
#pragma once

#include "item3d/core/math.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace item3d {

/// The UVs of a triangle's corners; (0, 0) is the top left corner of the image.
using UvTriangle = std::array<Vec2, 3>;

struct UvRaster {
    int width = 0;
    int height = 0;
    std::vector<std::int32_t>
        triangle;  ///< [height * width] index of the first that covers it, or -1
    std::int32_t at(int x, int y) const {
        return triangle[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x)];
    }
};

/// Samples at texel centres. UVs are snapped to 1/256 texel and edges belong to one side, so two
/// triangles that share an edge never both cover a texel. Both windings count. Textures repeat:
/// what leaves [0, 1] comes in on the other side. Triangles more than a texture wide are left out.
/// on_overlap(texel index, triangle that has it, triangle that covers it too) may be empty; it
/// returns whether to go on.
using OverlapFunction = std::function<bool(std::size_t, std::int32_t, std::int32_t)>;
UvRaster rasterize_uv(std::span<const UvTriangle> triangles, int width, int height,
                      const OverlapFunction& on_overlap = {});

/// Weights of the corners 0 and 1 at a texel's centre in [0, 1]^2, as the repeating texture shows
/// it in the triangle; moved into the triangle when it lies just outside.
Vec2 uv_barycentrics(const UvTriangle& triangle, Vec2 uv);

}  // namespace item3d
