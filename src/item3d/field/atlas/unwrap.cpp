#include "item3d/field/atlas/unwrap.h"

#include "item3d/core/error.h"

#include <xatlas.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace item3d {
namespace {

double surface_area(const Primitive& primitive) {
    double area = 0.0;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const Vec3 a = primitive.positions[primitive.indices[i]];
        const Vec3 b = primitive.positions[primitive.indices[i + 1]];
        const Vec3 c = primitive.positions[primitive.indices[i + 2]];
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

}  // namespace

std::vector<PrimitiveEdit> unwrap(const std::vector<const Primitive*>& primitives, int size) {
    const std::unique_ptr<xatlas::Atlas, decltype(&xatlas::Destroy)> atlas(xatlas::Create(),
                                                                           &xatlas::Destroy);
    double area = 0.0;
    for (const Primitive* primitive : primitives)
        area += surface_area(*primitive);
    // The mesh is rescaled and centred, because xatlas treats small triangles as degenerate by an
    // absolute threshold, and loses precision far from the origin.
    Vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (const Primitive* primitive : primitives) {
        for (const Vec3& p : primitive->positions)
            low = glm::min(low, p), high = glm::max(high, p);
    }
    const Vec3 center = 0.5f * low + 0.5f * high;
    const float scale = area > 0.0 ? static_cast<float>(std::sqrt(100.0 / area)) : 1.0f;
    for (const Primitive* primitive : primitives) {
        std::vector<Vec3> scaled = primitive->positions;
        for (Vec3& p : scaled)
            p = (p - center) * scale;
        xatlas::MeshDecl mesh;
        mesh.vertexCount = static_cast<std::uint32_t>(scaled.size());
        mesh.vertexPositionData = scaled.data();
        mesh.vertexPositionStride = sizeof(Vec3);
        if (primitive->normals.size() == scaled.size()) {
            mesh.vertexNormalData = primitive->normals.data();
            mesh.vertexNormalStride = sizeof(Vec3);
        }
        mesh.indexCount = static_cast<std::uint32_t>(primitive->indices.size());
        mesh.indexData = primitive->indices.data();
        mesh.indexFormat = xatlas::IndexFormat::UInt32;
        const xatlas::AddMeshError error =
            xatlas::AddMesh(atlas.get(), mesh, static_cast<std::uint32_t>(primitives.size()));
        if (error != xatlas::AddMeshError::Success) {
            throw InputError(primitive->name.empty() ? "mesh" : primitive->name,
                             "xatlas cannot make a UV map for it",
                             "unwrap it in a 3D modelling program");
        }
    }
    xatlas::ComputeCharts(atlas.get());

    xatlas::PackOptions options;
    options.padding = static_cast<std::uint32_t>(std::max(2, size / 256));
    options.texelsPerUnit = static_cast<float>(size * std::sqrt(0.7 / 100.0));
    // Without a fixed resolution, xatlas puts all charts into one atlas as large as they need. The
    // charts are shrunk until the atlas has about the image's size.
    for (int attempt = 0; attempt < 5; ++attempt) {
        xatlas::PackCharts(atlas.get(), options);
        const float ratio =
            static_cast<float>(std::max(atlas->width, atlas->height)) / static_cast<float>(size);
        if (ratio < 1.05f) break;
        options.texelsPerUnit /= ratio;
    }

    std::vector<PrimitiveEdit> edits;
    for (std::uint32_t m = 0; m < atlas->meshCount; ++m) {
        const xatlas::Mesh& mesh = atlas->meshes[m];
        PrimitiveEdit edit;
        for (std::uint32_t v = 0; v < mesh.vertexCount; ++v) {
            const xatlas::Vertex& vertex = mesh.vertexArray[v];
            edit.source_vertices.push_back(vertex.xref);
            const bool placed = vertex.atlasIndex >= 0;
            edit.uvs.push_back(
                placed ? glm::clamp(
                             Vec2(vertex.uv[0] / static_cast<float>(std::max(1u, atlas->width)),
                                  vertex.uv[1] / static_cast<float>(std::max(1u, atlas->height))),
                             0.0f, 1.0f)
                       : Vec2(0.0f));
        }
        edit.indices.assign(mesh.indexArray, mesh.indexArray + mesh.indexCount);
        ITEM3D_CHECK(edit.indices.size() == primitives[m]->indices.size(), "xatlas lost triangles");
        edits.push_back(std::move(edit));
    }
    return edits;
}

}  // namespace item3d
