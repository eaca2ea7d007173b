// Zonal sums over cube maps: what prefiltering is made of. They are symmetric: the transpose of
// each is the same sum the other way.
#pragma once

#include "item3d/render/kernels/zonal_lanes.h"
#include "item3d/render/prefilter/cube_planes.h"

#include <functional>

namespace item3d {

/// Unit directions of the texels of face 0 and of its halo, as three planes.
class CubeDirections {
  public:
    CubeDirections(int size, at::Device device);
    /// Of texel (0, 0).
    const float* data() const;
    std::int64_t plane_step() const { return row_ * row_; }

  private:
    std::int64_t row_;
    at::Tensor values_;
};

/// Gets the sums of row_tile texels of all planes, [planes, row_tile].
using RowSums = std::function<void(int row, int column, const float* sums)>;

/// On the CPU's threads. Sums of a kernel that reaches at most three texels at a face's centre
/// (eight at a corner), at the source's own size, plus `coarse` upsampled, a map of half the size
/// (null: none). Halos: the source's full, one texel of the coarse map's.
void near_sums(const CubePlanes& source, const CubeDirections& directions,
               const kernels::ZonalKernel& kernel, const CubePlanes* coarse, const RowSums& finish);

/// The same, of all texels, added to planes of the same size, on any device.
void add_near_sums(const CubePlanes& source, const CubeDirections& directions,
                   const kernels::ZonalKernel& kernel, CubePlanes& to);

/// Sums of any kernel at the source's own size, every texel with every other. The halo of the
/// result is left as it is.
CubePlanes far_sums(const CubePlanes& source, const kernels::ZonalKernel& kernel);

/// Sums of max(0, n.l). The halo of the result is left as it is.
CubePlanes cosine_sums(const CubePlanes& source, int out_size);

}  // namespace item3d
