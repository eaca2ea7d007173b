#include "item3d/field/atlas/atlas.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/field/atlas/unwrap.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace item3d {
namespace {

constexpr int largest_texture = 4096;
constexpr int default_texture = 1024;
constexpr int overlap_resolution = 1024;
/// Below these shares of the surface a flaw costs less than the UV map's loss would.
constexpr double tolerated_overlap = 0.005;
constexpr double tolerated_collapse = 0.01;
/// How far beyond [0, 1] a UV may lie: rounding, or half a texel of a small texture.
constexpr float tolerated_margin = 1e-3f;
/// Farther out floats no longer tell texels apart.
constexpr float farthest_repetition = 16.0f;

std::string percent(double share) {
    const long whole = std::lround(100.0 * share);
    return (whole == 0 ? std::string("less than 1") : std::to_string(whole)) + " %";
}

UvTriangle corners_of(const std::vector<Vec2>& uvs, const std::vector<std::uint32_t>& indices,
                      std::size_t first) {
    return {uvs[indices[first]], uvs[indices[first + 1]], uvs[indices[first + 2]]};
}

/// Indices into Model::textures, the base colour's first.
std::vector<int> textures_of(const Material& material) {
    std::vector<int> textures;
    for (const int index : {material.base_color_texture, material.metallic_roughness_texture,
                            material.occlusion_texture, material.normal_texture})
        if (index >= 0) textures.push_back(index);
    return textures;
}

bool has_textures(const Model& model, int material) {
    return !textures_of(model.materials[static_cast<std::size_t>(material)]).empty();
}

/// Whether all textures of the material repeat along an axis; those that an edit adds do.
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

/// A triangle that shows each of its texels once: inside the unit square, or across the border of
/// one that repeats.
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

bool have_uvs(const Model& model, const std::vector<int>& primitives) {
    return std::all_of(primitives.begin(), primitives.end(), [&](int index) {
        const Primitive& primitive = model.primitives[static_cast<std::size_t>(index)];
        return primitive.uvs.size() == primitive.positions.size();
    });
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
            const UvTriangle uv = corners_of(primitive.uvs, primitive.indices, i);
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
            // Less than a thousandth of a texel of the largest texture.
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
        // Enough is enough: a thousand faces may each show the whole texture.
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

std::pair<int, int> atlas_size(const Model& model, int material, int texture_size,
                               bool has_new_uvs) {
    const int texture = model.materials[static_cast<std::size_t>(material)].base_color_texture;
    double width = default_texture, height = default_texture;
    if (texture >= 0 && !model.textures[static_cast<std::size_t>(texture)].image.empty()) {
        width = model.textures[static_cast<std::size_t>(texture)].image.width;
        height = model.textures[static_cast<std::size_t>(texture)].image.height;
    }
    if (has_new_uvs) width = height = std::max({width, height, double{default_texture}});
    const double longest = std::max(width, height);
    const double wanted =
        std::min<double>(largest_texture, texture_size > 0 ? texture_size : longest);
    const auto scaled = [&](double edge) {
        return std::max(1, static_cast<int>(std::lround(edge * wanted / longest)));
    };
    return {scaled(width), scaled(height)};
}

UvWrap wrap_of(const Model& model, int material) {
    const std::vector<int> textures =
        textures_of(model.materials[static_cast<std::size_t>(material)]);
    if (textures.empty()) return {};
    const Texture& first = model.textures[static_cast<std::size_t>(textures.front())];
    return {first.wrap_u, first.wrap_v};
}

Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size, UvPolicy policy) {
    Atlas atlas;
    std::vector<std::size_t> first_triangle(model.primitives.size() + 1, 0);
    for (std::size_t i = 0; i < model.primitives.size(); ++i) {
        first_triangle[i + 1] = first_triangle[i] + model.primitives[i].indices.size() / 3;
    }
    atlas.triangles.assign(first_triangle.back(), UvTriangle{Vec2(0.0f), Vec2(0.0f), Vec2(0.0f)});
    for (const int material : materials) {
        std::vector<int> firsts;
        for (std::size_t i = 0; i < model.primitives.size(); ++i) {
            const int index = static_cast<int>(i);
            if (model.primitives[i].material == material && space.first_instance()[i] == index) {
                firsts.push_back(index);
            }
        }
        if (firsts.empty()) continue;
        std::string problem = find_uv_problem(model, firsts);
        const std::string& name = model.materials[static_cast<std::size_t>(material)].name;
        const bool keeps = policy == UvPolicy::keep ||
                           (policy == UvPolicy::automatic && has_textures(model, material));
        if (keeps && !problem.empty() && have_uvs(model, firsts)) {
            note("material '" + name + "': " + problem +
                 ", and is kept: places that share texels change alike (--uv new gives each its "
                 "own, in a new UV map)");
            atlas.shared[material] = std::exchange(problem, "");
        } else if (policy == UvPolicy::make_new && problem.empty()) {
            problem = "a new UV map is asked for";
        }
        std::vector<PrimitiveEdit> edits;
        if (!problem.empty()) {
            note("material '" + name + "': " + problem + ", so xatlas made a new one");
            atlas.remade[material] = problem;
            std::vector<const Primitive*> parts;
            for (const int index : firsts) {
                parts.push_back(&model.primitives[static_cast<std::size_t>(index)]);
            }
            const auto [width, height] = atlas_size(model, material, texture_size, true);
            edits = unwrap(parts, std::max(width, height));
        }
        for (std::size_t k = 0; k < firsts.size(); ++k) {
            const Primitive& primitive = model.primitives[static_cast<std::size_t>(firsts[k])];
            const std::vector<Vec2>& uvs = problem.empty() ? primitive.uvs : edits[k].uvs;
            const auto& indices = problem.empty() ? primitive.indices : edits[k].indices;
            const std::size_t first = first_triangle[static_cast<std::size_t>(firsts[k])];
            for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
                atlas.triangles[first + i / 3] = corners_of(uvs, indices, i);
                atlas.material_triangles[material].push_back(
                    static_cast<std::int32_t>(first + i / 3));
            }
            if (problem.empty()) continue;
            for (std::size_t i = 0; i < model.primitives.size(); ++i) {
                if (space.first_instance()[i] != firsts[k]) continue;
                PrimitiveEdit edit = edits[k];
                // A mirrored copy lists its triangles' corners in the other order.
                if (model.primitives[i].is_mirrored != primitive.is_mirrored) {
                    for (std::size_t t = 0; t + 2 < edit.indices.size(); t += 3) {
                        std::swap(edit.indices[t + 1], edit.indices[t + 2]);
                    }
                }
                atlas.primitives[static_cast<int>(i)] = std::move(edit);
            }
        }
    }
    return atlas;
}

Primitive apply(const PrimitiveEdit& edit, const Primitive& primitive) {
    Primitive result = primitive;
    const auto gather = [&](auto& target, const auto& source) {
        target.clear();
        if (source.empty()) return;
        for (const std::uint32_t vertex : edit.source_vertices)
            target.push_back(source.at(vertex));
    };
    gather(result.positions, primitive.positions);
    gather(result.normals, primitive.normals);
    gather(result.colors, primitive.colors);
    for (std::size_t k = 0; k < result.further_uvs.size(); ++k)
        gather(result.further_uvs[k], primitive.further_uvs[k]);
    result.tangents.clear();
    result.uvs = edit.uvs;
    result.indices = edit.indices;
    return result;
}

}  // namespace item3d
