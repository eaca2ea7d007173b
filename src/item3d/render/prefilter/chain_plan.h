// The plan of the prefiltered chain, that is, its lobes and the resolutions at which they are
// summed.
#pragma once

#include "item3d/render/kernels/zonal.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace item3d {

inline constexpr int min_environment_size = 16, max_environment_size = 1024;

/// True if an environment with faces of this size can be prefiltered, that is, for powers of two in
/// [min_environment_size, max_environment_size].
constexpr bool can_prefilter(std::int64_t size) {
    return size >= min_environment_size && size <= max_environment_size && (size & (size - 1)) == 0;
}

/// Summation plan of a lobe: near sums on its own level and on coarser levels, and far sums on the
/// last level.
struct Lobe {
    float roughness;
    std::size_t level;
    std::vector<kernels::ZonalKernel> near;
    kernels::ZonalKernel far;
    std::size_t last() const { return level + near.size(); }
};

struct ChainPlan {
    std::vector<int> sizes;   ///< resolutions of the environment, finest first
    std::vector<Lobe> lobes;  ///< one for each level of EnvironmentLight
    std::size_t cosine = 0;   ///< level for irradiance, at most 128 texels
    int lobe_size(std::size_t lobe) const { return sizes[lobes[lobe].level]; }
};

/// Returns the plan for an environment of faces of `size` texels (can_prefilter()).
ChainPlan plan_chain(int size);

}  // namespace item3d
