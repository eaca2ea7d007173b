// Photographs of an object made of boxes, which looks different from each side.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/render/rasterize.h"
#include "tests/support/reconstruct.h"

#include <vector>

namespace item3d::testing {

/// Returns the mesh of closed boxes, each given by two opposite corners.
inline TriangleMesh box_mesh(const std::vector<std::array<Vec3, 2>>& boxes) {
    std::vector<float> positions;
    std::vector<std::int64_t> triangles;
    for (const auto& box : boxes) {
        const auto first = static_cast<std::int64_t>(positions.size() / 3);
        for (int corner = 0; corner < 8; ++corner)
            for (int a = 0; a < 3; ++a)
                positions.push_back(box[corner >> a & 1][a]);
        // The indices of the face's four corners have the same bit number `axis`.
        for (int axis = 0; axis < 3; ++axis) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
            for (const int side : {0, 1 << axis})
                for (const int corner :
                     {side, side + u, side + u + v, side, side + u + v, side + v})
                    triangles.push_back(first + corner);
        }
    }
    const auto count = static_cast<std::int64_t>(positions.size() / 3);
    return {at::tensor(positions).reshape({count, 3}), at::tensor(triangles).reshape({-1, 3})};
}

/// Returns an L-shaped mesh of a long, a middle and a short arm.
inline TriangleMesh three_arms() {
    return box_mesh({{Vec3(-0.2f, -0.6f, -0.2f), Vec3(0.2f, 0.7f, 0.2f)},
                     {Vec3(0.2f, -0.6f, -0.2f), Vec3(0.75f, -0.25f, 0.2f)},
                     {Vec3(-0.2f, -0.1f, 0.2f), Vec3(0.1f, 0.2f, 0.55f)}});
}

/// Returns a dataset of grey photographs of a mesh from all around. Its radius is set as
/// load_dataset() would set it.
inline Dataset photographs_of(const TriangleMesh& mesh, int count, int size) {
    Geometry geometry;
    geometry.positions = mesh.positions;
    geometry.triangles = mesh.triangles.to(at::kInt);
    Dataset dataset;
    dataset.radius = 1.35f;
    for (Camera camera : ring_of_cameras(count)) {
        fit_depth_range(camera, {Vec3(-1.5f), Vec3(1.5f)});
        constexpr int samples = 3;  // number of samples along each side of a pixel
        const Raster raster = rasterize(geometry, {camera}, samples * size, samples * size);
        const auto* triangle = raster.triangle.const_data_ptr<std::int32_t>();
        Photograph view{camera.name, camera, Image(size, size, 4)};
        for (int y = 0; y < samples * size; ++y)
            for (int x = 0; x < samples * size; ++x)
                if (*triangle++ >= 0)
                    for (int c = 0; c < 4; ++c)
                        view.image.at(x / samples, y / samples, c) +=
                            (c == 3 ? 1.0f : 0.5f) / (samples * samples);
        dataset.train.push_back(std::move(view));
    }
    return dataset;
}

inline TriangleMesh transformed(const TriangleMesh& mesh, const Mat4& matrix) {
    TriangleMesh result{mesh.positions.clone(), mesh.triangles};
    float* p = result.positions.data_ptr<float>();
    for (std::int64_t i = 0; i < result.positions.size(0); ++i, p += 3) {
        const Vec4 moved = matrix * Vec4(p[0], p[1], p[2], 1);
        for (int a = 0; a < 3; ++a)
            p[a] = moved[a];
    }
    return result;
}

}  // namespace item3d::testing
