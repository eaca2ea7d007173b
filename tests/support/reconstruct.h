// Small datasets and lattices for the reconstruction tests.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/lattice.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace item3d::testing {

/// Creates an empty temporary folder and returns its path.
inline std::filesystem::path fresh_folder(const std::string& name) {
    const auto folder =
        std::filesystem::path(::testing::TempDir()) / ("item3d_reconstruct_" + name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

/// Returns cameras at distance 4 around the origin, in a world with +Y up. Each camera sees the
/// whole sphere of radius 1.2.
inline std::vector<Camera> ring_of_cameras(int count) {
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const float turn = 2 * pi * static_cast<float>(i) / static_cast<float>(count);
        cameras.push_back(orbit_camera(Vec3(0), 4, turn, i % 3 == 0 ? 0.7f : -0.2f, 0.7f));
        cameras.back().name = "view_" + std::to_string(i);
    }
    return cameras;
}

/// Returns an image of a disk of one colour, with alpha.
inline Image disk_image(int width, int height, float radius = 0.3f) {
    Image image(width, height, 4);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width) - 0.5f;
            const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height) - 0.5f;
            const bool inside = u * u + v * v < radius * radius;
            image.at(x, y, 0) = 0.8f;
            image.at(x, y, 1) = 0.4f;
            image.at(x, y, 2) = 0.2f;
            image.at(x, y, 3) = inside ? 1.0f : 0.0f;
        }
    }
    return image;
}

inline nlohmann::json rows_of(const Mat4& pose) {
    nlohmann::json rows = nlohmann::json::array();
    for (int r = 0; r < 4; ++r)
        rows.push_back({pose[0][r], pose[1][r], pose[2][r], pose[3][r]});
    return rows;
}

/// Returns the rotation from a world with +Y up to one with +Z up.
inline Mat4 y_up_to_z_up() {
    return Mat4(Mat3(1, 0, 0, 0, 0, 1, 0, -1, 0));
}

inline Lattice cube_lattice(int cells) {
    return {Vec3(-1.0f), 2.0f / static_cast<float>(cells), {cells, cells, cells}};
}

/// Returns the signed distances of the lattice's vertices to a sphere of radius 0.7, whose centre
/// is not a vertex.
inline at::Tensor sphere_values(const at::Tensor& points) {
    const at::Tensor centre = at::tensor({0.03f, -0.02f, 0.05f});
    return (points - centre).norm(2, 1) - 0.7f;
}

/// Returns random signed values for a small lattice, such that the inside does not touch the
/// border.
inline at::Tensor random_values(Lattice& lattice, std::uint64_t seed) {
    at::manual_seed(seed);
    lattice = cube_lattice(6);
    lattice.cells = {6, 5, 7};
    const at::Tensor inner = at::constant_pad_nd(at::ones({6, 4, 5}), {1, 1, 1, 1, 1, 1}, 0) > 0;
    const at::Tensor values = at::randn({8, 6, 7});
    return at::where(inner, values, at::ones_like(values)).reshape({-1});
}

/// Expects a closed mesh: the triangles use each edge once in each direction.
inline void expect_closed(const at::Tensor& triangles) {
    std::map<std::pair<std::int64_t, std::int64_t>, int> edges;
    const auto* t = triangles.const_data_ptr<std::int64_t>();
    for (std::int64_t i = 0; i < triangles.size(0); ++i)
        for (int c = 0; c < 3; ++c)
            ++edges[{t[3 * i + c], t[3 * i + (c + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
}

}  // namespace item3d::testing
