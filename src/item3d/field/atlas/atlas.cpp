#include "item3d/field/atlas/atlas.h"

#include "item3d/core/progress.h"
#include "item3d/field/atlas/unwrap.h"
#include "item3d/field/atlas/uv_problem.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace item3d {
namespace {

constexpr int largest_texture = 4096;
constexpr int default_texture = 1024;

/// Returns the index of each primitive's first triangle in Geometry.
std::vector<std::size_t> first_triangles(const Model& model) {
    std::vector<std::size_t> first;
    std::size_t count = 0;
    for (const Primitive& primitive : model.primitives) {
        first.push_back(count);
        count += primitive.indices.size() / 3;
    }
    return first;
}

/// True if vertex colours vary over the surface.
bool has_vertex_colors(const Model& model, const TextureSet& set) {
    std::optional<Vec4> first;
    for (const int index : set.primitives) {
        const Primitive& primitive = model.primitives[static_cast<std::size_t>(index)];
        for (const Vec4& color : primitive.colors) {
            if (!first) first = color;
            if (color != *first) return true;
        }
    }
    return false;
}

}  // namespace

bool Atlas::has_shared_texels() const {
    return std::any_of(sets.begin(), sets.end(),
                       [](const TextureSet& set) { return !set.shared.empty(); });
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

Atlas choose_uvs(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 UvPolicy policy) {
    Atlas atlas;
    atlas.sets = texture_sets(model, space, materials);
    atlas.triangles.assign(model.triangle_count(), UvTriangle{Vec2(0.0f), Vec2(0.0f), Vec2(0.0f)});
    const std::vector<std::size_t> first_triangle = first_triangles(model);
    for (TextureSet& set : atlas.sets) {
        const Material& material = model.materials[static_cast<std::size_t>(set.materials.front())];
        const std::string problem = find_uv_problem(model, set.primitives);
        const bool has_textures = !textures_of(material).empty();
        const bool keeps =
            policy == UvPolicy::keep || (policy == UvPolicy::automatic && has_textures) ||
            (policy == UvPolicy::recolored && (has_textures || !has_vertex_colors(model, set)));
        if (keeps && !problem.empty() && have_uvs(model, set.primitives)) {
            note(names_of(model, set) + ": " + problem +
                 "; it is kept, so parts of the surface that share texels get the same edit (use "
                 "item3d edit --uv new for a UV map without shared texels)");
            set.shared = problem;
        } else if (!problem.empty() || policy == UvPolicy::make_new) {
            set.remade = problem.empty() ? "a new UV map was requested" : problem;
            note(names_of(model, set) + ": " + set.remade + "; xatlas makes a new UV map");
        }
        for (const int index : set.primitives) {
            const Primitive& primitive = model.primitives[static_cast<std::size_t>(index)];
            std::size_t triangle = first_triangle[static_cast<std::size_t>(index)];
            for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3, ++triangle) {
                set.triangles.push_back(static_cast<std::int32_t>(triangle));
                if (set.is_own())
                    atlas.triangles[triangle] = uv_corners(primitive.uvs, primitive.indices, i);
            }
        }
    }
    return atlas;
}

void add_new_uvs(const Model& model, const FieldSpace& space, int texture_size, Atlas& atlas) {
    const std::vector<std::size_t> first_triangle = first_triangles(model);
    for (const TextureSet& set : atlas.sets) {
        if (set.is_own()) continue;
        std::vector<const Primitive*> parts;
        for (const int index : set.primitives)
            parts.push_back(&model.primitives[static_cast<std::size_t>(index)]);
        const auto [width, height] = atlas_size(model, set.materials.front(), texture_size, true);
        const std::vector<PrimitiveEdit> edits = unwrap(parts, std::max(width, height));
        for (std::size_t k = 0; k < edits.size(); ++k) {
            const std::size_t first = first_triangle[static_cast<std::size_t>(set.primitives[k])];
            for (std::size_t i = 0; i + 2 < edits[k].indices.size(); i += 3)
                atlas.triangles[first + i / 3] = uv_corners(edits[k].uvs, edits[k].indices, i);
            for (std::size_t i = 0; i < model.primitives.size(); ++i) {
                if (space.first_instance()[i] != set.primitives[k]) continue;
                PrimitiveEdit edit = edits[k];
                // A mirrored instance lists its triangles' corners in reverse order.
                if (model.primitives[i].is_mirrored != parts[k]->is_mirrored) {
                    for (std::size_t t = 0; t + 2 < edit.indices.size(); t += 3)
                        std::swap(edit.indices[t + 1], edit.indices[t + 2]);
                }
                atlas.primitives[static_cast<int>(i)] = std::move(edit);
            }
        }
    }
}

Atlas make_atlas(const Model& model, const FieldSpace& space, const std::vector<int>& materials,
                 int texture_size, UvPolicy policy) {
    Atlas atlas = choose_uvs(model, space, materials, policy);
    add_new_uvs(model, space, texture_size, atlas);
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
