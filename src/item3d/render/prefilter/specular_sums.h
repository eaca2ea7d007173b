// Zonal sums over cube maps, which are the steps of prefiltering. The sums are symmetric: the
// transpose of a sum is the same sum with source and output exchanged.
//
//     near_sums    taps within reach around each texel, six faces at once      O(texels x taps)
//     far_sums     all pairs of texels within the kernel's cone                O(texels^2)
//     cosine_sums  all pairs, max(0, n.l) by its even and odd halves           a quarter of them
//
// kernels/zonal.h derives the sums and describes their layout. kernels/cube_planes.h describes the
// layout of planes.
#pragma once

#include "item3d/render/kernels/zonal_lanes.h"
#include "item3d/render/prefilter/cube_planes.h"

#include <functional>

namespace item3d {

/// Unit directions of face 0's texels and halo, as three planes.
class CubeDirections {
  public:
    CubeDirections(int size, const PrefilterBackend& backend);
    /// Returns the direction of texel (0, 0).
    const float* data() const;
    std::int64_t plane_step() const { return row_ * row_; }

  private:
    std::int64_t row_;
    Floats values_;
};

/// Function that receives the sums of row_tile texels of all planes, [planes, row_tile].
using RowSums = std::function<void(int row, int column, const float* sums)>;

/// Sums a kernel that reaches at most three texels at a face's centre (eight at a corner), at the
/// source's own size, on the CPU's threads. Adds the upsampled `coarse`, a map of half the size,
/// unless it is null. The source must have a full halo, and the coarse map a halo of one texel.
void near_sums(const CubePlanes& source, const CubeDirections& directions,
               const kernels::ZonalKernel& kernel, const CubePlanes* coarse, const RowSums& finish);

/// Adds the near sums of all texels to planes of the same size, on any device.
void add_near_sums(const CubePlanes& source, const CubeDirections& directions,
                   const kernels::ZonalKernel& kernel, CubePlanes& to);

/// Sums any kernel at the source's own size, over all pairs of texels. Leaves the halo of the
/// result unset.
CubePlanes far_sums(const CubePlanes& source, const kernels::ZonalKernel& kernel);

/// Sums max(0, n.l). Leaves the halo of the result unset.
CubePlanes cosine_sums(const CubePlanes& source, int out_size);

}  // namespace item3d
