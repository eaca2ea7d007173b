// Up direction and region of interest of a dataset.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <utility>

namespace item3d {

/// Returns the rotation that takes the dataset's up direction to +Y. up: "x", "-x", "y", ... or
/// "auto". With "auto", the up direction is the layout's own. If the layout has none, it is the
/// mean of the cameras' up axes, snapped to a coordinate axis within 20 degrees. Throws InputError
/// for other names.
Mat3 upright(const SourceDataset& source, const std::string& up);

/// Returns the point nearest to the cameras' optical axes (least squares), and the radius of a
/// sphere around this point. For each image there is a largest sphere that the image shows
/// completely; the radius is the median over the images. For parallel axes the point lies in front
/// of the cameras' mean position, at the largest distance of a camera from that position.
std::pair<Vec3, float> region_seen(const std::vector<Photograph>& views);

}  // namespace item3d
