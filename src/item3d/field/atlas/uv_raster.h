// Rasterization of an atlas, which finds the triangle that covers each texel. Independent of
// LibTorch.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace item3d {

/// UVs of a triangle's corners; (0, 0) is the top left corner of the image.
using UvTriangle = std::array<Vec2, 3>;

/// Returns the UVs of the triangle whose corners are indices[first], [first + 1] and [first + 2].
inline UvTriangle uv_corners(std::span<const Vec2> uvs, std::span<const std::uint32_t> indices,
                             std::size_t first) {
    return {uvs[indices[first]], uvs[indices[first + 1]], uvs[indices[first + 2]]};
}

/// Wrap modes of a texture for UVs beyond [0, 1].
struct UvWrap {
    Wrap u = Wrap::repeat;
    Wrap v = Wrap::repeat;
};

/// The triangle that covers a texel, and the repetition of the texture in which it does.
/// unwrap_coordinate() with tile_u and tile_v maps the texel's (u, v) in [0, 1]^2 to the triangle's
/// own UVs.
struct UvOwner {
    std::int32_t triangle = -1;  ///< -1: no triangle
    std::int16_t tile_u = 0;     ///< floor of the UV's coordinate
    std::int16_t tile_v = 0;
};

struct UvRaster {
    int width = 0;
    int height = 0;
    UvWrap wrap;
    std::vector<UvOwner> owners;  ///< [height * width] first triangle that covers each texel

    const UvOwner& owner(int x, int y) const {
        return owners[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    std::int32_t at(int x, int y) const { return owner(x, y).triangle; }
    /// Returns the texel's centre in the UVs of its owner.
    Vec2 uv_at(int x, int y) const;
};

/// Maps a coordinate of [0, 1] to a repetition of the texture.
float unwrap_coordinate(float folded, int tile, Wrap wrap);

/// Maps a coordinate to [0, 1] by the wrap mode.
float wrap_coordinate(float coordinate, Wrap wrap);

/// Called for a texel that two triangles cover, with the texel's index and both owners. Returns
/// whether the rasterization continues.
using OverlapFunction = std::function<bool(std::size_t, const UvOwner&, const UvOwner&)>;

/// Finds the triangle at each texel's centre. UVs are snapped to 1/256 texel, and ties on edges go
/// to one side, so two triangles that share an edge never both cover a texel. Both windings count.
/// UVs beyond [0, 1] are wrapped. For a triangle that repeats the texture many times, only the
/// repetitions around its middle count. on_overlap may be empty.
UvRaster rasterize_uv(std::span<const UvTriangle> triangles, int width, int height,
                      UvWrap wrap = {}, const OverlapFunction& on_overlap = {});

/// Gives each triangle that covers no texel the free texels around its middle, which bilinear
/// filtering reads. A model whose texture is a palette of colours has such triangles.
void claim_texels(UvRaster& raster, std::span<const UvTriangle> triangles);

/// Assigns free texels beside covered ones to their neighbour's owner, because bilinear filtering
/// reads them along the borders of charts.
void widen(UvRaster& raster);

/// Returns the barycentric weights of corners 0 and 1 at the point `uv`, clamped to the triangle.
Vec2 uv_barycentrics(const UvTriangle& triangle, Vec2 uv);

}  // namespace item3d
