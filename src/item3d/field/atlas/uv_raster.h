// Which triangle of an atlas covers which texel. No torch here.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace item3d {

/// The UVs of a triangle's corners; (0, 0) is the top left corner of the image.
using UvTriangle = std::array<Vec2, 3>;

/// UVs of the triangle whose corners are indices[first], [first + 1] and [first + 2].
inline UvTriangle uv_corners(std::span<const Vec2> uvs, std::span<const std::uint32_t> indices,
                             std::size_t first) {
    return {uvs[indices[first]], uvs[indices[first + 1]], uvs[indices[first + 2]]};
}

/// How a texture continues beyond [0, 1].
struct UvWrap {
    Wrap u = Wrap::repeat;
    Wrap v = Wrap::repeat;
};

/// A triangle and the repetition of the texture in which it covers a texel: a texel at (u, v) in
/// [0, 1]^2 lies at unwrap(...) in the triangle's own UVs.
struct UvOwner {
    std::int32_t triangle = -1;  ///< -1: none
    std::int16_t tile_u = 0;     ///< floor of the UV
    std::int16_t tile_v = 0;
};

struct UvRaster {
    int width = 0;
    int height = 0;
    UvWrap wrap;
    std::vector<UvOwner> owners;  ///< [height * width], the first triangle that covers each texel

    const UvOwner& owner(int x, int y) const {
        return owners[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    std::int32_t at(int x, int y) const { return owner(x, y).triangle; }
    /// The texel's centre in the UVs of its owner.
    Vec2 uv_at(int x, int y) const;
};

/// A coordinate of [0, 1] in a repetition of the texture.
float unwrap_coordinate(float folded, int tile, Wrap wrap);

/// The coordinate of [0, 1] that a texture shows at `coordinate`.
float wrap_coordinate(float coordinate, Wrap wrap);

/// Samples at texel centres. UVs are snapped to 1/256 texel and edges belong to one side, so two
/// triangles that share an edge never both cover a texel. Both windings count. What leaves [0, 1]
/// comes in as `wrap` says. Of a triangle that shows the texture many times, the repetitions
/// around its middle count.
/// on_overlap(texel index, owner, what covers it too) may be empty; it returns whether to go on.
using OverlapFunction = std::function<bool(std::size_t, const UvOwner&, const UvOwner&)>;
UvRaster rasterize_uv(std::span<const UvTriangle> triangles, int width, int height,
                      UvWrap wrap = {}, const OverlapFunction& on_overlap = {});

/// Gives triangles without any texel, which are smaller than one, the free texels around their
/// middle that linear filtering looks up: those of palettes.
void claim_texels(UvRaster& raster, std::span<const UvTriangle> triangles);

/// Gives free texels beside covered ones their neighbour's owner, which linear filtering looks up
/// along the borders of charts.
void widen(UvRaster& raster);

/// Weights of the corners 0 and 1 at `uv` in the triangle's own UVs; moved into the triangle when
/// it lies just outside.
Vec2 uv_barycentrics(const UvTriangle& triangle, Vec2 uv);

}  // namespace item3d
