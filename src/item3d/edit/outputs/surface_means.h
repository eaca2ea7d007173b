// Mean material values over a surface, by area: what an edit changed, in numbers.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

struct SurfaceMeans {
    Vec3 base_color{0.0f};  ///< linear RGB
    float roughness = 0;
    float metallic = 0;
};

/// Of the named materials (indices into Model::materials), at 20,000 points that depend on the
/// seed.
SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           std::uint64_t seed = 0);

}  // namespace item3d
