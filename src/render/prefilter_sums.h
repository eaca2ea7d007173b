// Zonal sums over cube maps, on the CPU's threads: what prefiltering is made of. They are
// symmetric: the transpose of each is the same sum the other way.
#pragma once

#include "item3d/render/kernels/zonal.h"

#include <functional>
#include <memory>

namespace item3d {

/// Unit directions of the texels of face 0 and of its halo, as three planes.
class CubeDirections {
  public:
    explicit CubeDirections(int size);
    /// Of texel (0, 0).
    const float* data() const { return values_.get() + kernels::CubePlanes::halo * (row_ + 1); }
    std::int64_t plane_step() const { return row_ * row_; }

  private:
    std::int64_t row_;
    std::unique_ptr<float[]> values_;
};

/// Gets the sums of row_tile texels of all planes, [planes, row_tile].
using RowSums = std::function<void(int row, int column, const float* sums)>;

/// Sums of a kernel that reaches at most three texels at a face's centre (eight at a corner), at
/// the source's own size, plus `coarse` upsampled, a map of half the size (null: none). Halos: the
/// source's full, one texel of the coarse map's.
void near_sums(const kernels::CubePlanes& source, const CubeDirections& directions,
               const kernels::ZonalKernel& kernel, const kernels::CubePlanes* coarse,
               const RowSums& finish);

/// Sums of any kernel at the source's own size, every texel with every other. The halo of the
/// result is left as it is.
kernels::CubePlanes far_sums(const kernels::CubePlanes& source, const kernels::ZonalKernel& kernel);

/// Sums of max(0, n.l). The halo of the result is left as it is.
kernels::CubePlanes cosine_sums(const kernels::CubePlanes& source, int out_size);

}  // namespace item3d
