// Irradiance over a chain of cube maps: what a matte surface sees.
#pragma once

#include "item3d/render/kernels/irradiance.h"
#include "item3d/render/prefilter/cube_planes.h"

namespace item3d {

using kernels::irradiance_size;

/// Texels that hold so much of the light, a sun's, that max(0, n.l) of each shows its kink where it
/// sets: [64] int64 indices into [6, S, S], -1 where there are no more. flux: radiance times solid
/// angle. Does not wait for a device.
at::Tensor bright_texels(const CubePlanes& flux);

/// Sums of max(0, n.l) at irradiance_size: of the bright texels one by one, of all others at half
/// that size, upsampled. flux: at most irradiance_size, its halo full. The result has no halo.
CubePlanes irradiance_sums(const CubePlanes& flux, const at::Tensor& bright);

/// The transpose for the same bright texels: a gradient of the sums, its halo full -> of the flux,
/// with `size` texels and without a halo.
CubePlanes irradiance_sums_transposed(const CubePlanes& gradient, int size,
                                      const at::Tensor& bright);

}  // namespace item3d
