// The surface in the pieces that its maker gave it.
#pragma once

#include "item3d/region/selector.h"

#include <vector>

namespace item3d {

/// Triangles that belong together: connected across edges that are no creases, of one material, and
/// of about one base colour.
struct SurfacePatches {
    std::vector<int> of_triangle;       ///< [T] the triangle's patch
    std::vector<double> area;           ///< [patches]
    std::vector<double> triangle_area;  ///< [T]
};

SurfacePatches find_patches(const RegionScene& scene);

}  // namespace item3d
