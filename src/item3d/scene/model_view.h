// Views of a whole model.
#pragma once

#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"

namespace item3d {

/// A three-quarter view from a little above, through a lens that is neither wide nor long.
inline constexpr float default_azimuth = 35 * pi / 180;
inline constexpr float default_elevation = 18 * pi / 180;
inline constexpr float default_field_of_view = 30 * pi / 180;

/// The whole model from these angles (radians), as large as it fits. aspect: width / height.
Camera view_from(const Model& model, float azimuth, float elevation, float aspect);
/// From the default ones.
Camera default_view(const Model& model, float aspect);

}  // namespace item3d
