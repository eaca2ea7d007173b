// The soft border of a region.
#pragma once

#include "item3d/core/math.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace item3d {

/// From 0 at the nearest place outside a region to 1 `width` away from it, smoothly. Distances are
/// those in space to points of the outside.
class Feather {
  public:
    /// outside: [K, 3] on the CPU; width: in the units of positions, above 0.
    Feather(const at::Tensor& outside, float width);

    /// positions: [P, 3] on the CPU; inside: [P], where it is 0 nothing is looked for.
    at::Tensor weight(const at::Tensor& positions, const at::Tensor& inside) const;

  private:
    using Cell = std::uint64_t;
    float nearest(Vec3 position) const;

    float width_;
    std::unordered_map<Cell, std::vector<Vec3>> cells_;  ///< with edges of `width_`
};

}  // namespace item3d
