#include "item3d/scene/camera.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

namespace item3d {
namespace {

Vec3 to_device(const Camera& camera, Vec3 point, int width, int height) {
    const Vec4 clip = camera.world_to_clip(width, height) * Vec4(point, 1);
    return Vec3(clip) / clip.w;
}

std::filesystem::path temporary(const std::string& name, const std::string& text) {
    const auto path = std::filesystem::path(testing::TempDir()) / ("item3d_camera_" + name);
    write_atomically(path, text);
    return path;
}

const std::string identity = "[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]";

TEST(Camera, LooksAlongMinusZWithYUp) {
    Camera camera;
    camera.field_of_view_x = pi / 2;
    camera.near_plane = 1;
    camera.far_plane = 9;
    const Vec3 right_edge = to_device(camera, Vec3(2, 0, -2), 200, 100);
    EXPECT_NEAR(right_edge.x, 1, 1e-5);
    EXPECT_NEAR(right_edge.y, 0, 1e-5);
    // An image that is half as high shows half as much above and below.
    EXPECT_NEAR(to_device(camera, Vec3(0, 1, -2), 200, 100).y, 1, 1e-5);
    EXPECT_NEAR(to_device(camera, Vec3(0, 0, -1), 200, 100).z, -1, 1e-5);
    EXPECT_NEAR(to_device(camera, Vec3(0, 0, -9), 200, 100).z, 1, 1e-5);
}

TEST(Camera, OrbitsFromPlusZTowardsPlusX) {
    const Vec3 target(1, 2, 3);
    EXPECT_LT(glm::distance(orbit_camera(target, 5, 0, 0, 1).position(), Vec3(1, 2, 8)), 1e-5);
    EXPECT_LT(glm::distance(orbit_camera(target, 5, pi / 2, 0, 1).position(), Vec3(6, 2, 3)), 1e-5);
    EXPECT_GT(orbit_camera(target, 5, 0, 0.5f, 1).position().y, 2);
    for (const float elevation : {-pi / 2, -0.4f, 0.0f, 1.0f, pi / 2}) {
        const Camera camera = orbit_camera(target, 5, 0.7f, elevation, 1);
        const Mat4 product = camera.world_to_camera() * camera.camera_to_world;
        for (int i = 0; i < 16; ++i) {
            EXPECT_NEAR(product[i / 4][i % 4], i / 4 == i % 4 ? 1 : 0, 1e-5) << elevation;
        }
        EXPECT_LT(glm::length(Vec2(to_device(camera, target, 64, 64))), 1e-5) << elevation;
    }
}

TEST(Camera, TurntableKeepsTheBoxBetweenItsPlanesFromAnyAzimuth) {
    const std::array<Vec3, 2> bounds{Vec3(-0.65f, 0, -0.5f), Vec3(0.65f, 0.7f, 0.5f)};
    for (const float first : {0.0f, 0.7f})
        for (const Camera& camera : turntable(bounds, 6, 0.3f, 0.6f, first))
            for (int corner = 0; corner < 8; ++corner) {
                const Vec3 point(bounds[corner & 1].x, bounds[corner >> 1 & 1].y,
                                 bounds[corner >> 2].z);
                const float depth = -(camera.world_to_camera() * Vec4(point, 1)).z;
                EXPECT_GT(depth, camera.near_plane) << camera.name;
                EXPECT_LT(depth, camera.far_plane) << camera.name;
            }
    const Camera turned = turntable(bounds, 1, 0.3f, 0.6f, 0.7f)[0];
    const Vec3 towards = Vec3(turned.camera_to_world[2]);
    EXPECT_NEAR(std::atan2(towards.x, towards.z), 0.7f, 1e-5f);
}

TEST(Camera, TurntableKeepsTheBoundingSphereInView) {
    const std::array<Vec3, 2> bounds{Vec3(-1, 0, 2), Vec3(3, 5, 4)};
    const Vec3 centre(1, 2.5f, 3);
    const float radius = 0.5f * glm::length(bounds[1] - bounds[0]);
    const auto cameras = turntable(bounds, 5, 0.3f, 0.6f);
    ASSERT_EQ(cameras.size(), 5u);
    EXPECT_EQ(cameras[3].name, "view_003");
    float widest = 0;
    for (const Camera& camera : cameras) {
        for (int i = 0; i < 400; ++i) {
            const float y = 1 - (2 * i + 1) / 400.0f;
            const float angle = 2.4f * i;
            const Vec3 direction(std::sqrt(1 - y * y) * std::cos(angle), y,
                                 std::sqrt(1 - y * y) * std::sin(angle));
            const Vec3 p = to_device(camera, centre + radius * direction, 64, 64);
            widest = std::max({widest, std::abs(p.x), std::abs(p.y)});
        }
    }
    EXPECT_LT(widest, 1);
    EXPECT_GT(widest, 0.9f);
}

TEST(Camera, FramesPointsInTheMiddleAtFiveSixthsOfTheImage) {
    std::vector<Vec3> points;
    for (int i = 0; i < 200; ++i) {
        points.emplace_back(3 * std::sin(0.7f * i), std::cos(0.3f * i), 0.005f * i);
    }
    for (const float aspect : {0.5f, 1.0f, 2.0f}) {
        const Camera camera = framing_camera(points, 0.6f, 0.3f, 0.6f, aspect);
        const int width = static_cast<int>(100 * aspect);
        Vec2 low(9);
        Vec2 high(-9);
        for (const Vec3& point : points) {
            const Vec3 p = to_device(camera, point, width, 100);
            low = glm::min(low, Vec2(p));
            high = glm::max(high, Vec2(p));
            EXPECT_LT(std::abs(p.z), 1);
        }
        const int tight = high.x > high.y ? 0 : 1;
        EXPECT_NEAR(high[tight], 5.0f / 6.0f, 1e-4) << aspect;
        EXPECT_NEAR(low[tight], -5.0f / 6.0f, 1e-4) << aspect;
        EXPECT_LE(high[1 - tight], 5.0f / 6.0f) << aspect;
        EXPECT_GE(low[1 - tight], -5.0f / 6.0f) << aspect;
    }
}

TEST(Camera, FramesAllCornersOfABox) {
    const std::array<Vec3, 2> bounds{Vec3(-3, -1, 0), Vec3(3, 1, 1)};
    const Camera camera = framing_camera(bounds, 0.6f, 0.3f, 0.6f);
    float widest = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner(bounds[i & 1].x, bounds[(i >> 1) & 1].y, bounds[i >> 2].z);
        const Vec3 p = to_device(camera, corner, 64, 64);
        widest = std::max({widest, std::abs(p.x), std::abs(p.y)});
    }
    EXPECT_NEAR(widest, 5.0f / 6.0f, 1e-4);
}

TEST(Camera, DepthRangeHoldsTheBoxEvenAroundTheCamera) {
    Camera camera = orbit_camera(Vec3(0), 0.5f, 0, 0, 1);
    fit_depth_range(camera, {Vec3(-10), Vec3(10)});
    EXPECT_GT(camera.near_plane, 0);
    EXPECT_GE(camera.far_plane, 10.5f);
    EXPECT_LT(camera.near_plane, camera.far_plane);
}

TEST(LoadCameras, ReadsNerfSynthetic) {
    const auto path = temporary("good.json",
                                R"({"camera_angle_x": 0.7, "frames": [
        {"file_path": "./test/r_0", "transform_matrix": )" +
                                    identity +
                                    R"(},
        {"file_path": "other/r_0.png", "transform_matrix": )" +
                                    identity +
                                    R"(, "camera_angle_x": 0.5},
        {"file_path": "shot.001", "transform_matrix": [[0,0,1,4],[0,1,0,0],[-1,0,0,0],[0,0,0,1]]},
        {"file_path": "../..", "transform_matrix": )" +
                                    identity + "}]}");
    const auto cameras = load_cameras(path);
    ASSERT_EQ(cameras.size(), 4u);
    EXPECT_EQ(cameras[0].name, "r_0");
    EXPECT_EQ(cameras[1].name, "r_0_1");
    EXPECT_EQ(cameras[2].name, "shot.001");
    EXPECT_EQ(cameras[3].name, "frame_0003");
    EXPECT_FLOAT_EQ(cameras[0].field_of_view_x, 0.7f);
    EXPECT_FLOAT_EQ(cameras[1].field_of_view_x, 0.5f);
    EXPECT_EQ(cameras[0].position(), Vec3(0, 0, 4));
    // Rows of the file are rows of the matrix, so this camera is at +X and looks along -X.
    EXPECT_EQ(cameras[2].position(), Vec3(4, 0, 0));
    EXPECT_LT(glm::distance(Vec3(cameras[2].camera_to_world * Vec4(0, 0, -1, 0)), Vec3(-1, 0, 0)),
              1e-6);
}

TEST(LoadCameras, RefusesWhatIsNotACamera) {
    const std::vector<std::string> bad = {
        "",
        "[]",
        R"({"camera_angle_x": 0.7})",
        R"({"camera_angle_x": 0.7, "frames": []})",
        R"({"camera_angle_x": 0.7, "frames": [7]})",
        R"({"camera_angle_x": "wide", "frames": [{"transform_matrix": )" + identity + "}]}",
        R"({"camera_angle_x": 40, "frames": [{"transform_matrix": )" + identity + "}]}",
        R"({"frames": [{"transform_matrix": )" + identity + "}]}",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0]]}]})",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1]]}]})",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix":
            [[1,1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix":
            [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix":
            [[0,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
        R"({"camera_angle_x": 0.7, "frames": [{"transform_matrix":
            [[1e999,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
    };
    for (const std::string& text : bad) {
        EXPECT_THROW(load_cameras(temporary("bad.json", text)), InputError) << text;
    }
    EXPECT_THROW(load_cameras("/nowhere/transforms.json"), InputError);
}

}  // namespace
}  // namespace item3d
