#include "item3d/scene/camera.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/scene/pose.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace item3d {

namespace {

/// Smallest size of what a camera frames, in the model's units. One point has the size 0.
constexpr float smallest_size = 1e-12f;

Mat4 look_from(Vec3 eye, Vec3 backward) {
    const Vec3 up = std::abs(backward.y) > 0.9999f ? Vec3(0, 0, -1) : Vec3(0, 1, 0);
    const Vec3 right = glm::normalize(glm::cross(up, backward));
    Mat4 pose(1.0f);
    pose[0] = Vec4(right, 0);
    pose[1] = Vec4(glm::cross(backward, right), 0);
    pose[2] = Vec4(backward, 0);
    pose[3] = Vec4(eye, 1);
    return pose;
}

Vec3 orbit_direction(float azimuth, float elevation) {
    return Vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                std::cos(elevation) * std::cos(azimuth));
}

std::array<Vec3, 8> corners(std::array<Vec3, 2> bounds) {
    std::array<Vec3, 8> result;
    for (int i = 0; i < 8; ++i) {
        result[i] = Vec3(bounds[i & 1].x, bounds[(i >> 1) & 1].y, bounds[(i >> 2) & 1].z);
    }
    return result;
}

/// Returns a frame's name: "r_0" for "./train/r_0.png". Removes only extensions of images; other
/// dots are part of the name.
std::string frame_name(const std::string& file_path) {
    const std::filesystem::path path(file_path);
    static const std::set<std::string> extensions = {".png", ".jpg", ".jpeg", ".exr", ".hdr",
                                                     ".PNG", ".JPG", ".JPEG", ".webp"};
    const std::filesystem::path name =
        extensions.count(path.extension().string()) ? path.stem() : path.filename();
    return name == "." || name == ".." ? "" : name.string();
}

float checked_field_of_view(float angle, const std::string& subject) {
    if (!(angle > 1e-3f && angle < 3.1f)) {
        throw InputError(subject,
                         fmt::format("the field of view must be between 0.001 and 3.1 radians, "
                                     "found {:.6g}",
                                     angle),
                         "camera_angle_x is in radians");
    }
    return angle;
}

/// Reads camera_angle_x, or fl_x (pixels) with w; returns 0 when the object has neither.
float field_of_view_of(const nlohmann::json& object, const std::string& subject) {
    if (object.contains("camera_angle_x")) {
        return checked_field_of_view(
            finite_json_number(object["camera_angle_x"], subject, "camera_angle_x"), subject);
    }
    if (object.contains("fl_x") && object.contains("w")) {
        const float focal = finite_json_number(object["fl_x"], subject, "fl_x");
        const float width = finite_json_number(object["w"], subject, "w");
        return checked_field_of_view(2 * std::atan2(width / 2, focal), subject);
    }
    return 0;
}

/// Subtracts the origin from the numbers in the last column of a pose's rows.
void take_off(const glm::dvec3& origin, nlohmann::json& rows) {
    for (std::size_t i = 0; i < 3 && rows.is_array() && i < rows.size(); ++i) {
        if (!rows[i].is_array() || rows[i].size() != 4 || !rows[i][3].is_number()) continue;
        rows[i][3] = rows[i][3].get<double>() - origin[static_cast<int>(i)];
    }
}

}  // namespace

Mat4 Camera::world_to_camera() const {
    // The inverse of a rotation is its transpose.
    const Mat3 rotation = glm::transpose(Mat3(camera_to_world));
    Mat4 inverse(rotation);
    inverse[3] = Vec4(-(rotation * position()), 1);
    return inverse;
}

Mat4 Camera::world_to_clip(int width, int height) const {
    ITEM3D_CHECK(width > 0 && height > 0, fmt::format("invalid image size {}x{}", width, height));
    const float focal = 1 / std::tan(field_of_view_x / 2);
    Mat4 projection(0.0f);
    projection[0][0] = focal;
    projection[1][1] = focal * static_cast<float>(width) / static_cast<float>(height);
    projection[2][2] = -(far_plane + near_plane) / (far_plane - near_plane);
    projection[2][3] = -1;
    projection[3][2] = -2 * far_plane * near_plane / (far_plane - near_plane);
    return projection * world_to_camera();
}

Camera orbit_camera(Vec3 target, float distance, float azimuth, float elevation,
                    float field_of_view_x) {
    const Vec3 backward = orbit_direction(azimuth, elevation);
    Camera camera;
    camera.camera_to_world = look_from(target + distance * backward, backward);
    camera.field_of_view_x = field_of_view_x;
    camera.near_plane = 0.01f * distance;
    camera.far_plane = 100.0f * distance;
    return camera;
}

std::vector<Camera> turntable(std::array<Vec3, 2> bounds, int count, float elevation,
                              float field_of_view_x, float first_azimuth) {
    const Vec3 centre = 0.5f * (bounds[0] + bounds[1]);
    const float radius = std::max(0.5f * glm::length(bounds[1] - bounds[0]), smallest_size);
    const float distance = 1.02f * radius / std::sin(field_of_view_x / 2);
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const float azimuth =
            first_azimuth + 2 * pi * static_cast<float>(i) / static_cast<float>(count);
        cameras.push_back(orbit_camera(centre, distance, azimuth, elevation, field_of_view_x));
        cameras.back().name = fmt::format("view_{:03}", i);
        fit_depth_range(cameras.back(), bounds);
    }
    return cameras;
}

float horizontal_field_of_view(float field_of_view, float aspect) {
    return 2 * std::atan(std::tan(field_of_view / 2) * std::max(aspect, 1.0f));
}

Camera framing_camera(std::span<const Vec3> points, float azimuth, float elevation,
                      float field_of_view, float aspect) {
    ITEM3D_CHECK(!points.empty(), "there is nothing to frame");
    const float field_of_view_x = horizontal_field_of_view(field_of_view, aspect);
    const float slope_x = std::tan(field_of_view_x / 2) * (5.0f / 6.0f);
    const float slope_y = slope_x / aspect;
    std::array<Vec3, 2> bounds{points.front(), points.front()};
    for (const Vec3& point : points) {
        bounds[0] = glm::min(bounds[0], point);
        bounds[1] = glm::max(bounds[1], point);
    }
    const Vec3 centre = 0.5f * (bounds[0] + bounds[1]);
    const float size = std::max(glm::length(bounds[1] - bounds[0]), smallest_size);

    // The camera is `distance` in front of the centre and moved sideways by `offset`. A point p,
    // whose z is towards the camera, is inside the image if |p.x - offset.x| <= slope_x (distance -
    // p.z), and likewise for y. Each axis gives two lower bounds of `distance`. They are equal at
    // the offset that centres the points.
    const Mat4 axes = orbit_camera(Vec3(0), 0, azimuth, elevation, field_of_view_x).camera_to_world;
    Vec4 reach(-std::numeric_limits<float>::max());
    for (const Vec3& point : points) {
        const Vec3 p = glm::transpose(Mat3(axes)) * (point - centre);
        reach = glm::max(reach,
                         Vec4(p.x / slope_x, -p.x / slope_x, p.y / slope_y, -p.y / slope_y) + p.z);
    }
    const Vec2 offset =
        0.5f * Vec2((reach[0] - reach[1]) * slope_x, (reach[2] - reach[3]) * slope_y);
    const float distance =
        std::max({0.5f * (reach[0] + reach[1]), 0.5f * (reach[2] + reach[3]), 1e-3f * size});
    const Vec3 target = centre + offset.x * Vec3(axes[0]) + offset.y * Vec3(axes[1]);
    Camera camera = orbit_camera(target, distance, azimuth, elevation, field_of_view_x);
    fit_depth_range(camera, bounds);
    return camera;
}

Camera framing_camera(std::array<Vec3, 2> bounds, float azimuth, float elevation,
                      float field_of_view, float aspect) {
    return framing_camera(std::span<const Vec3>(corners(bounds)), azimuth, elevation, field_of_view,
                          aspect);
}

void fit_depth_range(Camera& camera, std::array<Vec3, 2> bounds) {
    const Mat4 view = camera.world_to_camera();
    float nearest = std::numeric_limits<float>::max();
    float farthest = 0;
    for (const Vec3& corner : corners(bounds)) {
        const float depth = -(view * Vec4(corner, 1)).z;
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    if (farthest <= 0) return;  // the box is behind the camera: any range is valid
    camera.far_plane = 1.01f * farthest;
    camera.near_plane = std::max(0.99f * nearest, 1e-3f * farthest);
    // A flat box seen head-on still needs a range.
    camera.near_plane = std::min(camera.near_plane, 0.98f * camera.far_plane);
}

std::vector<Camera> load_cameras(const std::filesystem::path& path, const glm::dvec3& origin) {
    const std::string subject = path.string();
    nlohmann::json document = parse_json_text(read_text(path), subject);
    if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array()) {
        throw InputError(subject, "expected an object with a list \"frames\"",
                         "use a transforms.json in the NeRF-synthetic format");
    }
    if (document["frames"].empty())
        throw InputError(subject, "\"frames\" is empty", "add a frame for each view");
    const float shared_field_of_view = field_of_view_of(document, subject);

    std::vector<Camera> cameras;
    std::set<std::string> names;
    for (nlohmann::json& frame : document["frames"]) {
        const std::string where = fmt::format("{}: frame {}", subject, cameras.size());
        if (!frame.is_object() || !frame.contains("transform_matrix")) {
            throw InputError(where, "expected an object with \"transform_matrix\"",
                             "use a transforms.json in the NeRF-synthetic format");
        }
        Camera camera;
        if (origin != glm::dvec3(0.0)) take_off(origin, frame["transform_matrix"]);
        camera.camera_to_world = pose_from_rows(frame["transform_matrix"], where);
        camera.field_of_view_x = field_of_view_of(frame, where);
        if (camera.field_of_view_x == 0) camera.field_of_view_x = shared_field_of_view;
        if (camera.field_of_view_x == 0) {
            throw InputError(where, "neither camera_angle_x nor fl_x and w are given",
                             "add one of them");
        }
        if (frame.contains("file_path") && frame["file_path"].is_string()) {
            camera.name = frame_name(frame["file_path"].get<std::string>());
        }
        if (camera.name.empty()) camera.name = fmt::format("frame_{:04}", cameras.size());
        const std::string wanted = camera.name;
        for (std::size_t i = cameras.size(); !names.insert(camera.name).second; ++i) {
            camera.name = fmt::format("{}_{}", wanted, i);
        }
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

}  // namespace item3d
