// Split-sum approximation (Karis 2013), summed over every texel of a map. The renderer uses
// prefiltered levels instead.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d::reference {

class ExactSplitSum {
  public:
    /// `map` is an equirectangular image. The sums run over finer x finer points in each texel, at
    /// which the map is interpolated bilinearly. Lobes of smooth surfaces need more than one point.
    ExactSplitSum(const Image& map, int finer);

    /// Returns radiance [P, 3] at points with the given unit normals and directions to the viewer.
    at::Tensor radiance(const std::vector<Vec3>& normals, const std::vector<Vec3>& views,
                        const std::vector<Vec3>& base_colors, float metallic,
                        float roughness) const;

  private:
    /// Returns the map prefiltered by GGX around a direction: the first sum of the approximation.
    Vec3 prefiltered(Vec3 direction, float roughness) const;

    Image map_;
    std::vector<Vec3> direction_, flux_;  ///< per texel; flux: radiance times solid angle
    std::vector<float> solid_angle_;
};

}  // namespace item3d::reference
