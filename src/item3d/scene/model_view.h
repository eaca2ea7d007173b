// Cameras that view a whole model.
#pragma once

#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Default view: a three-quarter view from slightly above, with a normal lens.
inline constexpr float default_azimuth = 35 * pi / 180;
inline constexpr float default_elevation = 18 * pi / 180;
inline constexpr float default_field_of_view = 30 * pi / 180;

/// Returns a camera that fits the whole model from these angles (radians). aspect: width / height.
Camera view_from(const Model& model, float azimuth, float elevation, float aspect);
/// Returns view_from() with the default angles.
Camera default_view(const Model& model, float aspect);

}  // namespace item3d
