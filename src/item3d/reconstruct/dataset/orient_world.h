// Up direction and region of interest of a dataset.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <utility>

namespace item3d {

/// Returns the rotation that takes the dataset's up to +Y. up: "x", "-x", "y", ..., or "auto": the
/// layout's own, else the mean of the cameras' up axes, snapped to a coordinate axis within 20
/// degrees. Throws InputError for other names.
Mat3 upright(const SourceDataset& source, const std::string& up);

/// Returns the point nearest to the cameras' optical axes (least squares), and the radius of a
/// sphere around it that nearly all images show whole. For parallel axes it is the point in front
/// of the cameras' middle at the distance of their spread.
std::pair<Vec3, float> region_seen(const std::vector<Photograph>& views);

}  // namespace item3d
