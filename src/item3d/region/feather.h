// The soft border of a region.
#pragma once

#include "item3d/core/math.h"
#include "item3d/region/point_grid.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// From 0 at the region's border to 1 `width` away from it, smoothly. The border is points outside
/// that lie beside points inside; distances are those in space.
class Feather {
  public:
    /// outside, inside: [K, 3] on the CPU, about `spacing` apart on the surface; width above 0. All
    /// three in the units of positions.
    Feather(const at::Tensor& outside, const at::Tensor& inside, float spacing, float width);

    /// positions: [P, 3] on the CPU; inside: [P], where it is 0 nothing is looked for.
    at::Tensor weight(const at::Tensor& positions, const at::Tensor& inside) const;

  private:
    PointGrid border_;
};

}  // namespace item3d
