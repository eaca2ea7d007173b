// Validation of camera poses in files.
#pragma once

#include "item3d/core/math.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace item3d {

/// Returns `pose` with axes of unit length. Throws InputError that begins with `subject` unless it
/// is a rotation, a translation, and optionally one scale for each axis.
Mat4 checked_pose(Mat4 pose, const std::string& subject);

/// Returns checked_pose() of a list of three or four rows of four numbers; the fourth row is 0 0 0
/// 1.
Mat4 pose_from_rows(const nlohmann::json& rows, const std::string& subject);

/// Returns a number of a JSON file. Throws InputError that names `what` if it is not a finite
/// number.
float finite_json_number(const nlohmann::json& value, const std::string& subject,
                         const std::string& what);

}  // namespace item3d
