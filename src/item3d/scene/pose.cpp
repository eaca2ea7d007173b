#include "item3d/scene/pose.h"

#include "item3d/core/error.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace item3d {

namespace {

InputError wrong_pose(const std::string& subject, const std::string& problem) {
    return InputError(subject, "transform_matrix " + problem,
                      "expected a camera-to-world matrix of four rows with four numbers");
}

}  // namespace

float finite_json_number(const nlohmann::json& value, const std::string& subject,
                         const std::string& what) {
    if (!value.is_number()) {
        throw InputError(subject, what + " must be a number, found " + value.type_name(),
                         "correct this number");
    }
    const float number = value.get<float>();
    if (!std::isfinite(number))
        throw InputError(subject, what + " is not a finite number", "correct this number");
    return number;
}

Mat4 checked_pose(Mat4 pose, const std::string& subject) {
    for (int axis = 0; axis < 3; ++axis) {
        const float length = glm::length(Vec3(pose[axis]));
        if (!(length > 1e-6f)) throw wrong_pose(subject, "has an axis of length zero");
        pose[axis] = Vec4(Vec3(pose[axis]) / length, pose[axis].w);
    }
    const Mat3 rotation(pose);
    // The tolerance is loose, because exporters round to few digits. Shears still exceed it.
    const Mat3 product = glm::transpose(rotation) * rotation;
    for (int i = 0; i < 9; ++i) {
        if (std::abs(product[i / 3][i % 3] - (i / 3 == i % 3 ? 1.0f : 0.0f)) > 0.02f) {
            throw wrong_pose(subject, "is not a rotation (its axes are not orthogonal)");
        }
    }
    if (glm::determinant(rotation) < 0) throw wrong_pose(subject, "contains a reflection");
    const Vec4 last(pose[0][3], pose[1][3], pose[2][3], pose[3][3]);
    if (glm::length(last - Vec4(0, 0, 0, 1)) > 1e-4f)
        throw wrong_pose(subject, "must end with the row 0 0 0 1");
    return pose;
}

Mat4 pose_from_rows(const nlohmann::json& rows, const std::string& subject) {
    if (!rows.is_array() || (rows.size() != 4 && rows.size() != 3))
        throw wrong_pose(subject, "must have 4 rows");
    Mat4 pose(1.0f);
    for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
        if (!rows[row].is_array() || rows[row].size() != 4) {
            throw wrong_pose(subject, "must have rows of 4");
        }
        for (int column = 0; column < 4; ++column) {
            pose[column][row] = finite_json_number(rows[row][column], subject, "transform_matrix");
        }
    }
    return checked_pose(pose, subject);
}

}  // namespace item3d
