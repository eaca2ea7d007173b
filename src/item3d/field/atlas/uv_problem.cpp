#include "item3d/field/atlas/uv_problem.h"

#include "item3d/field/atlas/texture_set.h"
#include "item3d/field/atlas/uv_raster.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

constexpr int overlap_resolution = 1024;
/// Maximum shares of the surface with overlapping or collapsed UVs for which the UV map is kept.
constexpr double tolerated_overlap = 0.005;
constexpr double tolerated_collapse = 0.01;
/// Tolerance for UVs beyond [0, 1], which come from rounding, or from half a texel of a small
/// texture.
constexpr float tolerated_margin = 1e-3f;
/// Repetition of the texture beyond which floats cannot resolve texels.
constexpr float farthest_repetition = 16.0f;

std::string percent(double share) {
    const long whole = std::lround(100.0 * share);
    return (whole == 0 ? std::string("less than 1") : std::to_string(whole)) + " %";
}

/// Axes along which all textures of the material repeat. Textures that an edit adds repeat along
/// both axes.
struct Repetition {
    bool u = true, v = true;
};

Repetition repetition_of(const Model& model, const Material& material) {
    Repetition repeats;
    for (const int index : textures_of(material)) {
        const Texture& texture = model.textures[static_cast<std::size_t>(index)];
        repeats.u = repeats.u && texture.wrap_u == Wrap::repeat;
        repeats.v = repeats.v && texture.wrap_v == Wrap::repeat;
    }
    return repeats;
}

/// True if a triangle shows each of its texels once. It then lies inside the unit square, or
/// crosses the square's border where the texture repeats.
bool is_placed(const UvTriangle& uv, Repetition repeats) {
    const Vec2 low = glm::min(uv[0], glm::min(uv[1], uv[2]));
    const Vec2 high = glm::max(uv[0], glm::max(uv[1], uv[2]));
    const auto is_good = [](float first, float last, bool repeating) {
        const bool inside = first >= -tolerated_margin && last <= 1.0f + tolerated_margin;
        const bool wraps = repeating && last - first <= 1.0f && first > -farthest_repetition &&
                           last < farthest_repetition;
        return inside || wraps;
    };
    bool finite = true;
    for (const Vec2& corner : uv) {
        finite = finite && std::isfinite(corner.x) && std::isfinite(corner.y);
    }
    return finite && is_good(low.x, high.x, repeats.u) && is_good(low.y, high.y, repeats.v);
}

}  // namespace

std::string find_uv_problem(const Model& model, const std::vector<int>& primitives) {
    std::vector<UvTriangle> triangles;
    std::vector<std::array<Vec3, 3>> places;
    double area = 0.0, collapsed = 0.0;
    Vec3 low(1e30f), high(-1e30f);
    for (const int index : primitives) {
        const Primitive& primitive = model.primitives[static_cast<std::size_t>(index)];
        if (primitive.uvs.size() != primitive.positions.size()) return "it has no UV map";
        const Repetition repeats =
            repetition_of(model, model.materials[static_cast<std::size_t>(primitive.material)]);
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const UvTriangle uv = uv_corners(primitive.uvs, primitive.indices, i);
            std::array<Vec3, 3> place;
            for (std::size_t c = 0; c < 3; ++c) {
                place[c] = primitive.positions[primitive.indices[i + c]];
                low = glm::min(low, place[c]);
                high = glm::max(high, place[c]);
            }
            if (!is_placed(uv, repeats)) return "its UV map leaves the unit square";
            const double face =
                0.5 * glm::length(glm::cross(place[1] - place[0], place[2] - place[0]));
            const Vec2 u = uv[1] - uv[0], v = uv[2] - uv[0];
            area += face;
            // The threshold is less than a thousandth of a texel of the largest texture.
            if (std::abs(u.x * v.y - u.y * v.x) < 1e-10f) collapsed += face;
            triangles.push_back(uv);
            places.push_back(place);
        }
    }
    if (collapsed > tolerated_collapse * area) {
        return "its UV map gives no texels to " + percent(collapsed / area) + " of the surface";
    }
    std::size_t overlaps = 0;
    constexpr std::size_t texel_count = std::size_t{overlap_resolution} * overlap_resolution;
    const float same_place = 1e-3f * glm::length(high - low);
    const auto on_overlap = [&](std::size_t texel, const UvOwner& first, const UvOwner& second) {
        const auto coordinate = [](std::size_t at, int tile) {
            return (static_cast<float>(at) + 0.5f) / overlap_resolution + static_cast<float>(tile);
        };
        const auto place = [&](const UvOwner& owner) {
            const auto i = static_cast<std::size_t>(owner.triangle);
            const Vec2 uv(coordinate(texel % overlap_resolution, owner.tile_u),
                          coordinate(texel / overlap_resolution, owner.tile_v));
            const Vec2 b = uv_barycentrics(triangles[i], uv);
            return places[i][0] * b.x + places[i][1] * b.y + places[i][2] * (1.0f - b.x - b.y);
        };
        if (glm::length(place(first) - place(second)) > same_place) ++overlaps;
        // Stops early, because a thousand faces may each show the whole texture.
        return static_cast<double>(overlaps) <= tolerated_overlap * texel_count;
    };
    const UvRaster raster =
        rasterize_uv(triangles, overlap_resolution, overlap_resolution, {}, on_overlap);
    const auto used = std::count_if(raster.owners.begin(), raster.owners.end(),
                                    [](const UvOwner& owner) { return owner.triangle >= 0; });
    if (used == 0) return "its UV map is smaller than a texel";
    const double share = static_cast<double>(overlaps) / static_cast<double>(used);
    if (share > tolerated_overlap) return "its UV map overlaps itself";
    return "";
}

}  // namespace item3d
