// Camera poses as files give them, checked.
#pragma once

#include "item3d/core/math.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace item3d {

/// `pose` with axes of unit length. Throws InputError that begins with `subject` unless it is a
/// rotation, a translation, and perhaps one scale for each axis.
Mat4 checked_pose(Mat4 pose, const std::string& subject);

/// checked_pose of a list of four rows of four numbers, or of three: the last is 0 0 0 1.
Mat4 pose_from_rows(const nlohmann::json& rows, const std::string& subject);

/// A number of a JSON file. Throws InputError naming `what` where it is none, or not finite.
float finite_json_number(const nlohmann::json& value, const std::string& subject,
                         const std::string& what);

}  // namespace item3d
