// What the renderer's tests share: small models, and gradients checked by finite differences.
#pragma once

#include "item3d/render/rasterize.h"
#include "item3d/render/shade.h"
#include "item3d/scene/sphere.h"

#include <gtest/gtest.h>
#include <torch/types.h>

#include <cmath>
#include <functional>

namespace item3d::testing {

/// Looks along -Z from (0, 0, distance).
inline Camera front_camera(float distance = 3, float field_of_view = 0.8f) {
    Camera camera;
    camera.camera_to_world[3] = Vec4(0, 0, distance, 1);
    camera.field_of_view_x = field_of_view;
    return camera;
}

/// Triangles over given vertices; normals +Z, tangents +X, UVs (x, -y).
inline Geometry make_geometry(const torch::Tensor& positions, const torch::Tensor& triangles) {
    const std::int64_t vertices = positions.size(0), count = triangles.size(0);
    Geometry geometry;
    geometry.positions = positions;
    geometry.normals = torch::tensor({0.0f, 0.0f, 1.0f}).repeat({vertices, 1});
    geometry.tangents = torch::tensor({1.0f, 0.0f, 0.0f, 1.0f}).repeat({vertices, 1});
    geometry.uvs = torch::stack({positions.select(1, 0), -positions.select(1, 1)}, 1).detach();
    geometry.colors = torch::ones({vertices, 4});
    geometry.triangles = triangles.to(torch::kInt32);
    geometry.triangle_material = torch::zeros({count}, torch::kInt32);
    geometry.triangle_primitive = torch::zeros({count}, torch::kInt32);
    return geometry;
}

/// A rectangle in the plane z, centred, facing +Z.
inline Geometry make_quad(float half_width, float half_height, float z = 0) {
    const float w = half_width, h = half_height;
    return make_geometry(torch::tensor({-w, -h, z, w, -h, z, w, h, z, -w, h, z}).reshape({4, 3}),
                         torch::tensor({0, 1, 2, 0, 2, 3}).reshape({2, 3}));
}

inline torch::Tensor unit_rows(const torch::Tensor& rows) {
    return rows / rows.norm(2, 1, true);
}

/// A smooth environment [6, S, S, 3] with some light from everywhere.
inline torch::Tensor smooth_cube(int size, std::uint64_t seed = 3) {
    torch::manual_seed(seed);
    const torch::Tensor coarse = torch::rand({1, 3, 6, 3, 3}) + 0.3f;
    std::vector<torch::Tensor> faces;
    for (int face = 0; face < 6; ++face)
        faces.push_back(
            torch::upsample_bicubic2d(coarse.select(2, face), {size, size}, /*align_corners=*/true)
                .squeeze(0)
                .permute({1, 2, 0}));
    return torch::stack(faces).contiguous();
}

/// Checks the gradient of f at x along random directions against central differences of the step
/// `epsilon`, with a random weight for each output. Sums are taken in double.
inline void check_gradient(const std::function<torch::Tensor(const torch::Tensor&)>& f,
                           const torch::Tensor& x, float epsilon, double tolerance,
                           int directions = 4) {
    torch::Tensor leaf = x.detach().clone().set_requires_grad(true);
    torch::manual_seed(11);
    const torch::Tensor out = f(leaf);
    const torch::Tensor weights = torch::randn_like(out.detach());
    (out * weights).sum().backward();
    ASSERT_TRUE(leaf.grad().defined());
    const torch::NoGradGuard no_gradient;
    const auto value = [&](const torch::Tensor& at) {
        return (f(at).to(torch::kFloat64) * weights).sum().item<double>();
    };
    for (int i = 0; i < directions; ++i) {
        const torch::Tensor direction = torch::randn_like(x);
        const double analytic = (leaf.grad().to(torch::kFloat64) * direction).sum().item<double>();
        const double numeric =
            (value(x + epsilon * direction) - value(x - epsilon * direction)) / (2.0 * epsilon);
        // Random signs cancel: errors are judged by the gradient's typical size.
        const double scale = leaf.grad().to(torch::kFloat64).norm().item<double>();
        EXPECT_GT(scale, 0);
        EXPECT_NEAR(analytic, numeric, tolerance * scale) << "direction " << i;
    }
}

}  // namespace item3d::testing
