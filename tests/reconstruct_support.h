// Small datasets, made by our own renderer.
#pragma once

#include "item3d/core/files.h"
#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/scene/io/save.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d::testing {

/// A folder that is empty at first.
inline std::filesystem::path fresh_folder(const std::string& name) {
    const auto folder =
        std::filesystem::path(::testing::TempDir()) / ("item3d_reconstruct_" + name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

/// Cameras around the origin at distance 4, in a world with +Y up; they see a sphere of radius 1.2.
inline std::vector<Camera> ring_of_cameras(int count) {
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const float turn = 2 * pi * static_cast<float>(i) / static_cast<float>(count);
        cameras.push_back(orbit_camera(Vec3(0), 4, turn, i % 3 == 0 ? 0.7f : -0.2f, 0.7f));
        cameras.back().name = "view_" + std::to_string(i);
    }
    return cameras;
}

/// A disk of one colour, and alpha.
inline Image disk_picture(int width, int height, float radius = 0.3f) {
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

/// (x, y, z) of a world with +Y up in one with +Z up.
inline Mat4 y_up_to_z_up() {
    return Mat4(Mat3(1, 0, 0, 0, 0, 1, 0, -1, 0));
}

}  // namespace item3d::testing
