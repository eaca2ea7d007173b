#include "item3d/region/part_selectors.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/io/part_names.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace item3d {
namespace {

constexpr std::size_t max_listed = 12;

[[noreturn]] void refuse_name(const SelectorText& text, const std::string& what,
                              const std::set<std::string>& known) {
    if (known.empty())
        throw InputError(text.whole, "the model has no " + what + " with a name",
                         "choose another selector");
    const std::vector<std::string> names(known.begin(), known.end());
    const std::size_t shown = std::min(names.size(), max_listed);
    throw InputError(
        text.whole, "the model has no such " + what,
        fmt::format("it has {}{}",
                    fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                    names.size() > shown ? fmt::format(" and {} more", names.size() - shown)
                                         : std::string()));
}

/// Returns the wanted name in the model's spelling.
std::string known_name(const SelectorText& text, const std::string& what,
                       const std::set<std::string>& known) {
    if (known.contains(text.value)) return text.value;
    for (const std::string& name : known)
        if (to_lower(name) == to_lower(text.value)) return name;
    refuse_name(text, what, known);
}

/// Selects whole primitives.
class PrimitiveSelector : public Selector {
  public:
    /// names: function that returns the names of a primitive.
    PrimitiveSelector(const SelectorText& text, const std::string& what, const RegionScene& scene,
                      const std::function<std::vector<std::string>(const Primitive&)>& names) {
        const std::vector<Primitive>& primitives = scene.model.primitives;
        std::vector<std::vector<std::string>> names_of;
        std::set<std::string> known;
        for (const Primitive& primitive : primitives) {
            names_of.push_back(names(primitive));
            for (const std::string& name : names_of.back())
                if (!name.empty()) known.insert(name);
        }
        const std::string name = known_name(text, what, known);
        std::vector<float> chosen(primitives.size(), 0.0f);
        const std::vector<int>& first = scene.space.first_instance();
        for (std::size_t i = 0; i < primitives.size(); ++i)
            if (std::find(names_of[i].begin(), names_of[i].end(), name) != names_of[i].end())
                chosen[static_cast<std::size_t>(first[i])] = 1.0f;
        for (std::size_t i = 0; i < primitives.size(); ++i)
            chosen[i] = chosen[static_cast<std::size_t>(first[i])];
        chosen_ = at::tensor(chosen);
    }
    at::Tensor weight(const Surface& surface) const override {
        return chosen_.index_select(0, surface.primitive.cpu());
    }

  private:
    at::Tensor chosen_;  ///< [primitives] 0 or 1
};

/// Selects triangles of the geometry, which are in the order of primitives and of their triangles.
class TriangleSelector : public Selector {
  public:
    explicit TriangleSelector(std::vector<float> chosen) : chosen_(at::tensor(chosen)) {}
    at::Tensor weight(const Surface& surface) const override {
        return chosen_.index_select(0, surface.triangle.cpu());
    }

  private:
    at::Tensor chosen_;  ///< [triangles] 0 or 1
};

/// Interpolates values at the corners of triangles by barycentric coordinates.
class CornerSelector : public Selector {
  public:
    CornerSelector(const Geometry& geometry, std::vector<Vec3> values)
        : values_(std::move(values)),
          positions_(geometry.positions.detach().cpu().contiguous()),
          triangles_(geometry.triangles.cpu().contiguous()) {}

    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor triangle = surface.triangle.cpu().contiguous();
        const at::Tensor position = surface.position.detach().cpu().contiguous();
        at::Tensor weights = at::empty({triangle.size(0)}, at::kFloat);
        const std::int64_t* t = triangle.const_data_ptr<std::int64_t>();
        const float* p = position.const_data_ptr<float>();
        float* out = weights.data_ptr<float>();
        parallel_for(
            "region_corners", triangle.size(0),
            [&](std::int64_t i) {
                out[i] = glm::dot(values_[static_cast<std::size_t>(t[i])],
                                  barycentrics(t[i], Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2])));
            },
            4096);
        return weights.clamp(0, 1);
    }

  private:
    Vec3 corner(std::int64_t triangle, int k) const {
        const float* p = positions_.const_data_ptr<float>() +
                         3 * triangles_.const_data_ptr<std::int32_t>()[3 * triangle + k];
        return {p[0], p[1], p[2]};
    }
    Vec3 barycentrics(std::int64_t triangle, Vec3 position) const {
        const Vec3 a = corner(triangle, 0);
        const Vec3 u = corner(triangle, 1) - a, v = corner(triangle, 2) - a, w = position - a;
        const float uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
        const float determinant = uu * vv - uv * uv;
        if (!(determinant > 0)) return Vec3(1.0f / 3);
        const float second = (vv * glm::dot(w, u) - uv * glm::dot(w, v)) / determinant;
        const float third = (uu * glm::dot(w, v) - uv * glm::dot(w, u)) / determinant;
        return {1 - second - third, second, third};
    }

    std::vector<Vec3> values_;  ///< one for each corner of each triangle
    at::Tensor positions_, triangles_;
};

}  // namespace

std::unique_ptr<Selector> select_material(const SelectorText& text, const RegionScene& scene) {
    return std::make_unique<PrimitiveSelector>(
        text, "material", scene, [&](const Primitive& primitive) {
            const auto index = static_cast<std::size_t>(primitive.material);
            return std::vector<std::string>{scene.model.materials[index].name};
        });
}

std::unique_ptr<Selector> select_node(const SelectorText& text, const RegionScene& scene) {
    return std::make_unique<PrimitiveSelector>(
        text, "node", scene,
        [&](const Primitive& primitive) { return node_names(scene.model, primitive); });
}

std::unique_ptr<Selector> select_mesh(const SelectorText& text, const RegionScene& scene) {
    return std::make_unique<PrimitiveSelector>(
        text, "mesh", scene, [&](const Primitive& primitive) {
            return std::vector<std::string>{mesh_name(scene.model, primitive)};
        });
}

std::unique_ptr<Selector> select_group(const SelectorText& text, const RegionScene& scene) {
    const Model& model = scene.model;
    std::set<std::string> known;
    for (const auto& names : model.groups)
        known.insert(names.begin(), names.end());
    const std::string name = known_name(text, "group", known);
    std::vector<float> chosen;
    for (const Primitive& primitive : model.primitives) {
        for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t) {
            const int group = primitive.triangle_groups.empty() ? -1 : primitive.triangle_groups[t];
            bool is_in = false;
            if (group >= 0) {
                const auto& names = model.groups[static_cast<std::size_t>(group)];
                is_in = std::find(names.begin(), names.end(), name) != names.end();
            }
            chosen.push_back(is_in ? 1.0f : 0.0f);
        }
    }
    return std::make_unique<TriangleSelector>(std::move(chosen));
}

std::unique_ptr<Selector> select_attribute(const SelectorText& text, const RegionScene& scene) {
    const std::vector<std::string> there = vertex_attribute_names(scene.model);
    const std::string name =
        known_name(text, "vertex attribute", std::set<std::string>(there.begin(), there.end()));
    std::vector<Vec3> values;
    for (const Primitive& primitive : scene.model.primitives) {
        const std::vector<float> of_vertices = vertex_attribute(scene.model, primitive, name);
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            Vec3 corners(0.0f);
            for (int k = 0; k < 3 && !of_vertices.empty(); ++k)
                corners[k] = of_vertices[primitive.indices[i + static_cast<std::size_t>(k)]];
            values.push_back(corners);
        }
    }
    return std::make_unique<CornerSelector>(scene.geometry, std::move(values));
}

}  // namespace item3d
