// Where up is, and what the cameras look at.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <utility>

namespace item3d {

/// The rotation that brings the dataset's up to +Y. up: "x", "-x", "y", ..., or "auto": the
/// layout's own, else the mean of the cameras' up axes, snapped to a coordinate axis within 20
/// degrees of it. Throws InputError on other names.
Mat3 upright(const SourceDataset& source, const std::string& up);

/// The point nearest to the cameras' optical axes (least squares), and the radius of a sphere
/// around it that nearly all pictures show whole. Axes that are all parallel give the point before
/// the middle of the cameras at the distance of their spread.
std::pair<Vec3, float> region_seen(const std::vector<Photograph>& views);

}  // namespace item3d
