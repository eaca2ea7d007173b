#include "item3d/field/atlas/shared_texels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace item3d {
namespace {

/// Number of columns in the table of representatives. The columns are:
///   0..8    the position at (u, v) in [0, 1]^2: (P0, P1, P2) = u * [0..2] + v * [3..5] + [6..8]
///   9..14   corners of the triangle's box, to which the position is clamped
///   15      the distance within which a point keeps its own position
constexpr std::size_t place_width = 16;
constexpr int largest_grid = 2048;
/// Width in texels of the margin around a UV island. The margin maps to the island's border.
constexpr int margin = 2;

double uv_area(const UvTriangle& uv) {
    const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    return 0.5 * std::abs(static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x);
}

/// Slope and offset of the map from [0, 1] to a repetition of the texture.
struct Unwrapping {
    float slope, offset;

    Unwrapping(int tile, Wrap wrap)
        : slope(unwrap_coordinate(1.0f, tile, wrap) - unwrap_coordinate(0.0f, tile, wrap)),
          offset(unwrap_coordinate(0.0f, tile, wrap)) {}
};

void append(std::vector<float>& row, Vec3 value) {
    row.insert(row.end(), {value.x, value.y, value.z});
}

void append_place(std::vector<float>& places, const UvTriangle& uv,
                  const std::array<Vec3, 3>& corners, Unwrapping u, Unwrapping v, double texel) {
    const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    const Vec3 along_a = corners[1] - corners[0], along_b = corners[2] - corners[0];
    const double determinant = static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
    const bool is_smaller = uv_area(uv) < texel;
    if (determinant == 0.0) {
        append(places, Vec3(0.0f));
        append(places, Vec3(0.0f));
        append(places, (corners[0] + corners[1] + corners[2]) / 3.0f);
    } else {
        const auto scale = static_cast<float>(1.0 / determinant);
        const Vec3 by_u = (along_a * b.y - along_b * a.y) * scale;
        const Vec3 by_v = (along_b * a.x - along_a * b.x) * scale;
        append(places, by_u * u.slope);
        append(places, by_v * v.slope);
        append(places, corners[0] + by_u * (u.offset - uv[0].x) + by_v * (v.offset - uv[0].y));
    }
    append(places, glm::min(corners[0], glm::min(corners[1], corners[2])));
    append(places, glm::max(corners[0], glm::max(corners[1], corners[2])));
    const double face = 0.5 * glm::length(glm::cross(along_a, along_b));
    // The tolerance is two texels, because a texel of the grid may have the row of a neighbouring
    // triangle of the same island.
    places.push_back(is_smaller ? 0.0f
                                : static_cast<float>(2.0 * std::sqrt(face * texel / uv_area(uv))));
}

/// Gives each texel without an owner the owner of an adjacent texel, `margin` times.
void dilate(std::vector<std::int64_t>& owner, int width, int height) {
    for (int layer = 0; layer < margin; ++layer) {
        const std::vector<std::int64_t> before = owner;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const std::size_t here = static_cast<std::size_t>(y) * width + x;
                if (before[here] != 0) continue;
                for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
                    const int nx = (x + dx + width) % width, ny = (y + dy + height) % height;
                    const std::int64_t found = before[static_cast<std::size_t>(ny) * width + nx];
                    if (found == 0) continue;
                    owner[here] = found;
                    break;
                }
            }
        }
    }
}

at::Tensor wrapped(const at::Tensor& coordinate, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return coordinate.clamp(0.0f, 1.0f);
    const at::Tensor tile = coordinate.floor();
    const at::Tensor inside = coordinate - tile;
    if (wrap == Wrap::repeat) return inside;
    return at::where(tile.remainder(2.0f) > 0.5f, 1.0f - inside, inside);
}

at::Tensor texel_of(const at::Tensor& coordinate, int count) {
    return (coordinate * static_cast<float>(count)).to(at::kLong).clamp(0, count - 1);
}

}  // namespace

SharedTexels::SharedTexels(const Model& model, const Atlas& atlas, int texture_size,
                           at::Device device) {
    std::vector<std::array<Vec3, 3>> corners;
    for (const Primitive& primitive : model.primitives) {
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
            corners.push_back({primitive.positions[primitive.indices[i]],
                               primitive.positions[primitive.indices[i + 1]],
                               primitive.positions[primitive.indices[i + 2]]});
    }
    std::vector<float> places(place_width, 0.0f);  // row 0 is for texels without an owner
    for (const TextureSet& set : atlas.sets) {
        if (!set.shared.empty()) add(model, atlas, set, texture_size, corners, places);
    }
    if (grids_.empty()) return;
    places_ = at::tensor(places, at::kFloat)
                  .view({-1, static_cast<std::int64_t>(place_width)})
                  .to(device);
    for (Grid& grid : grids_)
        grid.owner = grid.owner.to(device);
}

void SharedTexels::add(const Model& model, const Atlas& atlas, const TextureSet& set,
                       int texture_size, const std::vector<std::array<Vec3, 3>>& corners,
                       std::vector<float>& places) {
    Grid grid;
    grid.materials = set.materials;
    const int material = set.materials.front();
    const auto [width, height] = atlas_size(model, material, texture_size);
    grid.width = std::min(width, largest_grid);
    grid.height = std::min(height, largest_grid);
    grid.wrap = wrap_of(model, material);
    const std::vector<std::int32_t>& indices = set.triangles;
    std::vector<UvTriangle> triangles;
    for (const std::int32_t index : indices)
        triangles.push_back(atlas.triangles[static_cast<std::size_t>(index)]);
    UvRaster raster = rasterize_uv(triangles, grid.width, grid.height, grid.wrap);
    claim_texels(raster, triangles);

    const double texel = 1.0 / (static_cast<double>(grid.width) * grid.height);
    std::map<std::array<int, 3>, std::int64_t> rows;
    std::vector<std::int64_t> owner(raster.owners.size(), 0);
    for (std::size_t i = 0; i < owner.size(); ++i) {
        const UvOwner& found = raster.owners[i];
        if (found.triangle < 0) continue;
        const auto next = static_cast<std::int64_t>(places.size() / place_width);
        const auto [row, is_new] =
            rows.try_emplace({found.triangle, found.tile_u, found.tile_v}, next);
        if (is_new) {
            const auto t = static_cast<std::size_t>(found.triangle);
            append_place(places, triangles[t], corners[static_cast<std::size_t>(indices[t])],
                         Unwrapping(found.tile_u, grid.wrap.u),
                         Unwrapping(found.tile_v, grid.wrap.v), texel);
        }
        owner[i] = row->second;
    }
    dilate(owner, grid.width, grid.height);
    grid.owner = at::tensor(owner, at::kLong);
    grids_.push_back(std::move(grid));
}

at::Tensor SharedTexels::representatives(const Surface& surface,
                                         const at::Tensor& positions) const {
    if (empty()) return positions;
    const at::NoGradGuard no_grad;
    at::Tensor row = at::zeros({positions.size(0)}, positions.options().dtype(at::kLong));
    at::Tensor uv = surface.uv.detach();
    for (const Grid& grid : grids_) {
        const at::Tensor u = wrapped(surface.uv.select(1, 0), grid.wrap.u);
        const at::Tensor v = wrapped(surface.uv.select(1, 1), grid.wrap.v);
        const at::Tensor texel = texel_of(v, grid.height) * static_cast<std::int64_t>(grid.width) +
                                 texel_of(u, grid.width);
        at::Tensor here = surface.material.eq(static_cast<std::int64_t>(grid.materials.front()));
        for (std::size_t i = 1; i < grid.materials.size(); ++i)
            here = here | surface.material.eq(static_cast<std::int64_t>(grid.materials[i]));
        row = at::where(here, grid.owner.index_select(0, texel), row);
        uv = at::where(here.unsqueeze(1), at::stack({u, v}, 1), uv);
    }
    const at::Tensor place = places_.index_select(0, row);
    at::Tensor shown = place.narrow(1, 0, 3) * uv.narrow(1, 0, 1) +
                       place.narrow(1, 3, 3) * uv.narrow(1, 1, 1) + place.narrow(1, 6, 3);
    shown = at::minimum(at::maximum(shown, place.narrow(1, 9, 3)), place.narrow(1, 12, 3));
    const at::Tensor distance = at::sqrt((shown - positions).square().sum(1, true));
    const at::Tensor moves = row.ne(0).unsqueeze(1) & (distance > place.narrow(1, 15, 1));
    return at::where(moves, shown, positions);
}

}  // namespace item3d
