// Pinhole cameras in OpenGL's convention: x is right, y is up, and the camera looks along -z.
#pragma once

#include "item3d/core/math.h"

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace item3d {

struct Camera {
    std::string name;
    /// Matrix from camera space to world space, column-major as in glm. Its rotation is
    /// orthonormal.
    Mat4 camera_to_world{1.0f};
    /// Horizontal field of view in radians.
    float field_of_view_x = 0.8f;
    float near_plane = 0.05f;
    float far_plane = 100.0f;

    Vec3 position() const { return Vec3(camera_to_world[3]); }
    Mat4 world_to_camera() const;
    /// Returns the matrix to OpenGL's clip space: x, y, z in [-w, w]. width and height in pixels
    /// give the aspect ratio.
    Mat4 world_to_clip(int width, int height) const;
};

/// Returns a camera that looks at `target`. Angles are in radians. Azimuth 0 places the camera
/// towards +Z, pi/2 towards +X; a positive elevation places it above the target.
Camera orbit_camera(Vec3 target, float distance, float azimuth, float elevation,
                    float field_of_view_x);

/// Returns `count` cameras at equal angles around the box, the first at `first_azimuth`. Their
/// distance is such that the box's bounding sphere fits in a square view.
std::vector<Camera> turntable(std::array<Vec3, 2> bounds, int count, float elevation,
                              float field_of_view_x, float first_azimuth = 0);

/// Returns the camera from `azimuth` and `elevation` (radians) that shows all points centred and as
/// large as possible, with a margin of a twelfth of the image on each side. aspect: width / height;
/// the shorter side of the image spans `field_of_view`. For a model, pass its vertices rather than
/// the corners of its bounding box, which are often farther out than any vertex.
Camera framing_camera(std::span<const Vec3> points, float azimuth, float elevation,
                      float field_of_view, float aspect = 1.0f);

Camera framing_camera(std::array<Vec3, 2> bounds, float azimuth, float elevation,
                      float field_of_view, float aspect = 1.0f);

/// Returns the horizontal field of view of an image whose shorter side spans `field_of_view`
/// (radians).
float horizontal_field_of_view(float field_of_view, float aspect);

/// Sets near_plane and far_plane so that the box lies between them.
void fit_depth_range(Camera& camera, std::array<Vec3, 2> bounds);

/// Reads NeRF-synthetic transforms.json (camera_angle_x, frames[].transform_matrix, file_path).
/// Matrices are in the file's axes; `origin` (Model::origin) is subtracted from their positions. A
/// camera is named after its frame's file (no folder, no extension), made unique where two frames
/// share a name. Throws InputError.
std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace item3d
