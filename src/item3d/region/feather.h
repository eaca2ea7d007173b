// The soft border of a region.
#pragma once

#include "item3d/core/math.h"
#include "item3d/region/point_grid.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// A weight that rises smoothly from 0 at the region's border to 1 at distance `width`. The border
/// consists of outside points adjacent to inside points; distances are Euclidean.
class Feather {
  public:
    /// outside, inside: points [K, 3] on the CPU, about `spacing` apart on the surface. width must
    /// be positive. Points, spacing and width have the same unit.
    Feather(const at::Tensor& outside, const at::Tensor& inside, float spacing, float width);

    /// Returns the weights of `positions`, [P, 3] on the CPU. Points where `inside` [P] is 0 are
    /// skipped.
    at::Tensor weight(const at::Tensor& positions, const at::Tensor& inside) const;

  private:
    PointGrid border_;
};

}  // namespace item3d
