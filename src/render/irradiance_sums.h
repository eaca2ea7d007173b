// Irradiance over a chain of cube maps, on the CPU's threads: what a matte surface sees.
#pragma once

#include "item3d/render/kernels/cube_planes.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Of an irradiance map. Bilinear lookups in a coarser one show where a sun sets.
inline constexpr int irradiance_size = 128;

/// Texels that hold so much of the light, a sun's, that max(0, n.l) of each shows its kink where it
/// sets: indices into [6, S, S], ascending. flux: radiance times solid angle.
std::vector<std::int64_t> bright_texels(const kernels::CubePlanes& flux);

/// Sums of max(0, n.l) at irradiance_size: of the bright texels one by one, of all others at half
/// that size, upsampled. flux: at most irradiance_size, its halo full. The result has no halo.
kernels::CubePlanes irradiance_sums(const kernels::CubePlanes& flux,
                                    const std::vector<std::int64_t>& bright);

/// The transpose for the same bright texels: a gradient of the sums, its halo full -> of the flux,
/// with `size` texels and without a halo.
kernels::CubePlanes irradiance_sums_transposed(const kernels::CubePlanes& gradient, int size,
                                               const std::vector<std::int64_t>& bright);

}  // namespace item3d
