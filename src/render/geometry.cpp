#include "item3d/render/geometry.h"

#include "item3d/render/topology.h"

#include <cmath>

namespace item3d {
namespace {

/// Tangents from UVs (Lengyel 2001): the direction of growing u, orthogonal to the normal.
/// glTF's handedness: bitangent = cross(normal, tangent) * w points where v falls.
std::vector<Vec4> tangents_from_uvs(const Primitive& primitive) {
    std::vector<Vec3> along_u(primitive.positions.size(), Vec3(0.0f));
    std::vector<Vec3> along_v(primitive.positions.size(), Vec3(0.0f));
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const std::uint32_t* corner = &primitive.indices[i];
        const Vec3 edge1 = primitive.positions[corner[1]] - primitive.positions[corner[0]];
        const Vec3 edge2 = primitive.positions[corner[2]] - primitive.positions[corner[0]];
        const Vec2 uv1 = primitive.uvs[corner[1]] - primitive.uvs[corner[0]];
        const Vec2 uv2 = primitive.uvs[corner[2]] - primitive.uvs[corner[0]];
        const float area = uv1.x * uv2.y - uv2.x * uv1.y;
        if (area == 0.0f || !std::isfinite(area)) continue;
        // The length stays that of the triangle's area in space, whatever its scale in UV space.
        const float sign = area < 0 ? -1.0f : 1.0f;
        Vec3 u = sign * (edge1 * uv2.y - edge2 * uv1.y);
        Vec3 v = sign * (edge2 * uv1.x - edge1 * uv2.x);
        const float weight = glm::length(glm::cross(edge1, edge2));
        const float length_u = glm::length(u), length_v = glm::length(v);
        if (!(length_u > 0) || !(length_v > 0)) continue;
        u *= weight / length_u;
        v *= weight / length_v;
        for (int k = 0; k < 3; ++k) {
            along_u[corner[k]] += u;
            along_v[corner[k]] += v;
        }
    }
    std::vector<Vec4> tangents(primitive.positions.size());
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        const Vec3 normal = primitive.normals[i];
        Vec3 tangent = along_u[i] - normal * glm::dot(normal, along_u[i]);
        float handedness = 1.0f;
        if (glm::dot(tangent, tangent) > 1e-20f * glm::dot(along_u[i], along_u[i]) &&
            glm::dot(tangent, tangent) > 0) {
            handedness = glm::dot(glm::cross(normal, tangent), along_v[i]) > 0 ? -1.0f : 1.0f;
        } else {
            tangent = glm::cross(normal, std::abs(normal.x) < 0.9f ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
        }
        const float length = glm::length(tangent);
        tangents[i] = length > 0 ? Vec4(tangent / length, handedness) : Vec4(1, 0, 0, 1);
    }
    return tangents;
}

template <typename T>
torch::Tensor to_rows(const std::vector<T>& values, std::int64_t channels) {
    torch::Tensor tensor = torch::empty({static_cast<std::int64_t>(values.size()), channels});
    float* out = tensor.data_ptr<float>();
    for (const T& value : values)
        for (std::int64_t c = 0; c < channels; ++c)
            *out++ = value[static_cast<int>(c)];
    return tensor;
}

}  // namespace

Geometry Geometry::from_model(const Model& model, torch::Device device) {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> tangents, colors;
    std::vector<Vec2> uvs;
    std::vector<std::int32_t> triangles, materials, primitives;
    for (std::size_t index = 0; index < model.primitives.size(); ++index) {
        const Primitive& primitive = model.primitives[index];
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
        append(colors, primitive.colors, Vec4(1.0f));
        if (primitive.tangents.empty() && primitive.uvs.size() == count &&
            primitive.normals.size() == count)
            append(tangents, tangents_from_uvs(primitive), Vec4(0.0f));
        else
            append(tangents, primitive.tangents, Vec4(0.0f));
        for (const std::uint32_t vertex : primitive.indices)
            triangles.push_back(first + static_cast<std::int32_t>(vertex));
        materials.insert(materials.end(), primitive.indices.size() / 3, primitive.material);
        primitives.insert(primitives.end(), primitive.indices.size() / 3,
                          static_cast<std::int32_t>(index));
    }
    const auto to_indices = [](const std::vector<std::int32_t>& values) {
        return torch::tensor(values, torch::kInt32);
    };
    Geometry geometry;
    geometry.positions = to_rows(positions, 3);
    geometry.normals = to_rows(normals, 3);
    geometry.tangents = to_rows(tangents, 4);
    geometry.uvs = to_rows(uvs, 2);
    geometry.colors = to_rows(colors, 4);
    geometry.triangles = to_indices(triangles).reshape({-1, 3});
    geometry.triangle_material = to_indices(materials);
    geometry.triangle_primitive = to_indices(primitives);
    geometry.neighbours = triangle_neighbours(geometry.positions, geometry.triangles);
    for (torch::Tensor* tensor :
         {&geometry.positions, &geometry.normals, &geometry.tangents, &geometry.uvs,
          &geometry.colors, &geometry.triangles, &geometry.triangle_material,
          &geometry.triangle_primitive, &geometry.neighbours})
        *tensor = tensor->to(device);
    return geometry;
}

}  // namespace item3d
