// Helpers for the renderer's tests: small models, and gradient checks by finite differences.
#pragma once

#include "item3d/render/rasterize.h"
#include "item3d/render/shade.h"
#include "item3d/scene/sphere.h"
#include "item3d/tensors/tensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace item3d::testing {

/// Returns a camera that looks along -Z from (0, 0, distance).
inline Camera front_camera(float distance = 3, float field_of_view = 0.8f) {
    Camera camera;
    camera.camera_to_world[3] = Vec4(0, 0, distance, 1);
    camera.field_of_view_x = field_of_view;
    return camera;
}

/// Returns the geometry of triangles over the given vertices, with normals +Z, tangents +X and UVs
/// (x, -y).
inline Geometry make_geometry(const at::Tensor& positions, const at::Tensor& triangles) {
    const std::int64_t vertices = positions.size(0), count = triangles.size(0);
    Geometry geometry;
    geometry.positions = positions;
    geometry.normals = at::tensor({0.0f, 0.0f, 1.0f}).repeat({vertices, 1});
    geometry.tangents = at::tensor({1.0f, 0.0f, 0.0f, 1.0f}).repeat({vertices, 1});
    geometry.uvs = at::stack({positions.select(1, 0), -positions.select(1, 1)}, 1).detach();
    geometry.colors = at::ones({vertices, 4});
    geometry.triangles = triangles.to(at::kInt);
    geometry.triangle_material = at::zeros({count}, at::kInt);
    geometry.triangle_primitive = at::zeros({count}, at::kInt);
    return geometry;
}

/// Returns a centred rectangle in the plane z, facing +Z.
inline Geometry make_quad(float half_width, float half_height, float z = 0) {
    const float w = half_width, h = half_height;
    return make_geometry(at::tensor({-w, -h, z, w, -h, z, w, h, z, -w, h, z}).reshape({4, 3}),
                         at::tensor({0, 1, 2, 0, 2, 3}, at::kLong).reshape({2, 3}));
}

inline at::Tensor unit_rows(const at::Tensor& rows) {
    return rows / rows.norm(2, 1, true);
}

/// Returns a smooth environment [6, S, S, 3] with light from all directions.
inline at::Tensor smooth_cube(int size, std::uint64_t seed = 3) {
    at::manual_seed(seed);
    const at::Tensor coarse = at::rand({1, 3, 6, 3, 3}) + 0.3f;
    std::vector<at::Tensor> faces;
    for (int face = 0; face < 6; ++face)
        faces.push_back(
            at::upsample_bicubic2d(coarse.select(2, face), {size, size}, /*align_corners=*/true)
                .squeeze(0)
                .permute({1, 2, 0}));
    return at::stack(faces).contiguous();
}

/// Compares the gradient of a weighted sum of f's outputs at x, along random directions, with
/// central differences of step `epsilon`. The weights are random, and the sum is computed in
/// double.
inline void check_gradient(const std::function<at::Tensor(const at::Tensor&)>& f,
                           const at::Tensor& x, float epsilon, double tolerance,
                           int directions = 4) {
    at::Tensor leaf = x.detach().clone().set_requires_grad(true);
    at::manual_seed(11);
    const at::Tensor out = f(leaf);
    const at::Tensor weights = at::randn_like(out.detach());
    (out * weights).sum().backward();
    ASSERT_TRUE(leaf.grad().defined());
    const at::NoGradGuard no_gradient;
    const auto value = [&](const at::Tensor& at) {
        return (f(at).to(at::kDouble) * weights).sum().item<double>();
    };
    for (int i = 0; i < directions; ++i) {
        const at::Tensor direction = at::randn_like(x);
        const double analytic = (leaf.grad().to(at::kDouble) * direction).sum().item<double>();
        const double numeric =
            (value(x + epsilon * direction) - value(x - epsilon * direction)) / (2.0 * epsilon);
        // Errors are relative to the norm of the gradient, because the derivative along a random
        // direction can be close to zero.
        const double scale = leaf.grad().to(at::kDouble).norm().item<double>();
        EXPECT_GT(scale, 0);
        EXPECT_NEAR(analytic, numeric, tolerance * scale) << "direction " << i;
    }
}

}  // namespace item3d::testing
