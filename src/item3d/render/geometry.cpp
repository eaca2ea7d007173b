#include "item3d/render/geometry.h"

#include "item3d/render/tangents.h"
#include "item3d/render/topology.h"

#include <algorithm>

namespace item3d {
namespace {

template <typename T>
at::Tensor to_rows(const std::vector<T>& values, std::int64_t channels) {
    at::Tensor tensor = at::empty({static_cast<std::int64_t>(values.size()), channels});
    float* out = tensor.data_ptr<float>();
    for (const T& value : values)
        for (std::int64_t c = 0; c < channels; ++c)
            *out++ = value[static_cast<int>(c)];
    return tensor;
}

/// Adds MikkTSpace's tangents for the UV map of the normal texture to a primitive that has UVs and
/// normals.
void add_missing_tangents(const Model& model, Primitive& primitive) {
    if (!primitive.tangents.empty()) return;
    const auto material = static_cast<std::size_t>(primitive.material);
    const int map = material < model.materials.size() ? model.materials[material].normal_uvs : 0;
    std::vector<Vec2>* further = nullptr;
    if (map > 0) {
        if (static_cast<std::size_t>(map) > primitive.further_uvs.size()) return;
        further = &primitive.further_uvs[static_cast<std::size_t>(map) - 1];
    }
    const std::size_t count = primitive.positions.size();
    if ((further ? *further : primitive.uvs).size() != count || primitive.normals.size() != count)
        return;
    if (further) further->swap(primitive.uvs);
    add_tangents(primitive);
    if (further) further->swap(primitive.uvs);
}

}  // namespace

Geometry Geometry::from_model(const Model& model, at::Device device) {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> tangents, colors;
    std::vector<Vec2> uvs;
    std::size_t map_count = 0;
    for (const Primitive& primitive : model.primitives)
        map_count = std::max(map_count, primitive.further_uvs.size());
    std::vector<std::vector<Vec2>> further_uvs(map_count);
    std::vector<std::int32_t> triangles, materials, primitives;
    for (std::size_t index = 0; index < model.primitives.size(); ++index) {
        Primitive primitive = model.primitives[index];
        add_missing_tangents(model, primitive);
        const std::size_t count = primitive.positions.size();
        const std::int32_t first = static_cast<std::int32_t>(positions.size());
        const auto append = [&](auto& all, const auto& part, auto value) {
            if (part.size() == count)
                all.insert(all.end(), part.begin(), part.end());
            else
                all.insert(all.end(), count, value);
        };
        append(positions, primitive.positions, Vec3(0.0f));
        append(normals, primitive.normals, Vec3(0.0f));
        append(uvs, primitive.uvs, Vec2(0.0f));
        primitive.further_uvs.resize(map_count);
        for (std::size_t k = 0; k < map_count; ++k)
            append(further_uvs[k], primitive.further_uvs[k], Vec2(0.0f));
        append(colors, primitive.colors, Vec4(1.0f));
        append(tangents, primitive.tangents, Vec4(0.0f));
        for (const std::uint32_t vertex : primitive.indices)
            triangles.push_back(first + static_cast<std::int32_t>(vertex));
        materials.insert(materials.end(), primitive.indices.size() / 3, primitive.material);
        primitives.insert(primitives.end(), primitive.indices.size() / 3,
                          static_cast<std::int32_t>(index));
    }
    const auto to_indices = [](const std::vector<std::int32_t>& values) {
        return at::tensor(values, at::kInt);
    };
    Geometry geometry;
    geometry.positions = to_rows(positions, 3);
    geometry.normals = to_rows(normals, 3);
    geometry.tangents = to_rows(tangents, 4);
    geometry.uvs = to_rows(uvs, 2);
    for (const std::vector<Vec2>& further : further_uvs)
        geometry.further_uvs.push_back(to_rows(further, 2).to(device));
    geometry.colors = to_rows(colors, 4);
    geometry.triangles = to_indices(triangles).reshape({-1, 3});
    geometry.triangle_material = to_indices(materials);
    geometry.triangle_primitive = to_indices(primitives);
    geometry.neighbours = triangle_neighbours(geometry.positions, geometry.triangles);
    for (at::Tensor* tensor :
         {&geometry.positions, &geometry.normals, &geometry.tangents, &geometry.uvs,
          &geometry.colors, &geometry.triangles, &geometry.triangle_material,
          &geometry.triangle_primitive, &geometry.neighbours})
        *tensor = tensor->to(device);
    return geometry;
}

}  // namespace item3d
