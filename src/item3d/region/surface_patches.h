// The patches of a surface, as its author modelled it.
#pragma once

#include "item3d/region/selector.h"

#include <vector>

namespace item3d {

/// The triangles of a patch are connected across edges without creases, have one material, and have
/// similar base colours.
struct SurfacePatches {
    std::vector<int> of_triangle;       ///< [T] patch of each triangle
    std::vector<double> area;           ///< [patches]
    std::vector<double> triangle_area;  ///< [T]
};

SurfacePatches find_patches(const RegionScene& scene);

}  // namespace item3d
