#include "item3d/reconstruct/dataset/orient_world.h"

#include "item3d/core/error.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

Vec3 mean_up(const SourceDataset& source) {
    Vec3 sum(0.0f);
    for (const SourceView& view : source.views)
        sum += Vec3(view.camera_to_world[1]);
    if (glm::length(sum) < 1e-3f * static_cast<float>(source.views.size())) return {0, 1, 0};
    const Vec3 up = glm::normalize(sum);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(up[axis]) > std::cos(20.0f * pi / 180.0f)) {
            Vec3 snapped(0.0f);
            snapped[axis] = up[axis] > 0 ? 1.0f : -1.0f;
            return snapped;
        }
    }
    return up;
}

Vec3 named_axis(const std::string& up) {
    const bool negative = up.starts_with('-');
    const std::string axis = negative ? up.substr(1) : up;
    if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
        throw InputError("--up", "expected x, y, z, -x, -y, -z or auto, found '" + up + "'");
    }
    Vec3 direction(0.0f);
    direction[axis[0] - 'x'] = negative ? -1.0f : 1.0f;
    return direction;
}

}  // namespace

Mat3 upright(const SourceDataset& source, const std::string& up) {
    const Vec3 from = up != "auto" ? named_axis(up) : source.up ? *source.up : mean_up(source);
    const Vec3 to(0, 1, 0);
    if (glm::dot(from, to) > 0.999999f) return Mat3(1.0f);
    // Rotation by 180 degrees about x.
    if (glm::dot(from, to) < -0.999999f) return Mat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
    const float angle = std::acos(std::clamp(glm::dot(from, to), -1.0f, 1.0f));
    return Mat3(glm::rotate(Mat4(1.0f), angle, glm::cross(from, to)));
}

std::pair<Vec3, float> region_seen(const std::vector<Photograph>& views) {
    if (views.empty()) return {Vec3(0.0f), 1.0f};
    glm::dmat3 sum(0.0);
    glm::dvec3 right(0.0), middle(0.0);
    for (const Photograph& view : views) {
        const glm::dvec3 axis(-Vec3(view.camera.camera_to_world[2]));
        const glm::dvec3 eye(view.camera.position());
        // Distance to a line: the perpendicular part of the offset from its point.
        const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(axis, axis);
        sum += across;
        right += across * eye;
        middle += eye / static_cast<double>(views.size());
    }
    Vec3 centre;
    if (glm::determinant(sum) > 1e-6 * std::pow(static_cast<double>(views.size()), 3.0)) {
        centre = Vec3(glm::inverse(sum) * right);
    } else {
        float spread = 1e-3f;
        for (const Photograph& view : views)
            spread = std::max(spread, glm::distance(view.camera.position(), Vec3(middle)));
        centre = Vec3(middle) - spread * Vec3(views.front().camera.camera_to_world[2]);
    }
    std::vector<float> radii;
    for (const Photograph& view : views) {
        const float slope = std::tan(0.5f * view.camera.field_of_view_x);
        const float aspect =
            static_cast<float>(view.image.height) / static_cast<float>(view.image.width);
        const float half = std::atan(slope * std::min(1.0f, aspect));
        radii.push_back(glm::distance(view.camera.position(), centre) * std::sin(half));
    }
    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2),
                     radii.end());
    return {centre, std::max(radii[radii.size() / 2], 1e-6f)};
}

}  // namespace item3d
