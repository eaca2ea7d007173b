// The division of a surface into patches, as its author modelled them.
#pragma once

#include "item3d/region/selector.h"

#include <vector>

namespace item3d {

/// The triangles of a patch are connected across edges without creases, have one material, and have
/// similar base colours.
struct SurfacePatches {
    std::vector<int> of_triangle;       ///< [T] patch of each triangle
    std::vector<double> area;           ///< [patches] area of each patch
    std::vector<double> triangle_area;  ///< [T] area of each triangle
};

SurfacePatches find_patches(const RegionScene& scene);

}  // namespace item3d
