// Irradiance sums over a chain of cube maps, for diffuse surfaces.
//
//     sums = U C f' + B b        C: max(0, n.l) at 64 texels (kernels/irradiance.h); U: upsampling
//
// Here f' is the flux without its bright texels, restricted to 64 texels if it has 128. B b is the
// sum over the bright texels, one by one, at 128 texels.
//
//     flux  planes of up to 128 texels      sums  planes of 128 texels      bright  [64] indices
#pragma once

#include "item3d/render/kernels/irradiance.h"
#include "item3d/render/prefilter/cube_planes.h"

#include <cstdint>

namespace item3d {

using kernels::irradiance_size;

/// Maximum number of bright texels of a map.
inline constexpr int max_bright = 64;

/// Writes the indices [max_bright] into [6, S, S] of bright texels, such as the sun's; unused
/// entries are -1. A bright texel has so large a share of the light that the kink of its max(0,
/// n.l) is visible. flux: radiance times solid angle. The function does not synchronise with a
/// device.
void bright_texels(const CubePlanes& flux, std::int64_t* bright);

/// Sums max(0, n.l) at irradiance_size. The bright texels are summed exactly; all others are summed
/// at half that size and upsampled. flux: map of at most irradiance_size, with a full halo. The
/// result has no halo.
CubePlanes irradiance_sums(const CubePlanes& flux, const std::int64_t* bright);

/// Transpose of irradiance_sums() for the same bright texels. Maps a gradient with respect to the
/// sums, which needs a full halo, to the gradient with respect to the flux, which has `size` texels
/// and no halo.
CubePlanes irradiance_sums_transposed(const CubePlanes& gradient, int size,
                                      const std::int64_t* bright);

}  // namespace item3d
