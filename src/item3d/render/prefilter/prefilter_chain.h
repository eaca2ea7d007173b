// The prefiltered chain of split-sum lighting, on any backend. Every step is linear in the
// environment.
#pragma once

#include "item3d/render/prefilter/chain_plan.h"
#include "item3d/render/prefilter/cube_planes.h"
#include "item3d/render/prefilter/irradiance_sums.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Mean radiance of each texel, sums of radiance over sums of solid angle, in the caller's memory
/// on the backend.
struct MeanMap {
    int size;               ///< S
    float* mean;            ///< [6, S, S, 3]
    float* inverse_weight;  ///< [S, S], the same for each face
};

/// Sets the irradiance map, of irradiance_size, and a map for each of plan.lobes, in this order;
/// bright [max_bright] receives the texels whose irradiance is summed exactly. environment: of
/// plan.sizes.front() texels.
void prefilter_forward(const PrefilterBackend& backend, const ChainPlan& plan,
                       const CubeMap& environment, const std::vector<MeanMap>& maps,
                       std::int64_t* bright);

/// Gradient with respect to MeanMap::mean, and that map's weights.
struct MeanGradient {
    CubeMap gradient;  ///< values: null where there is none
    const float* inverse_weight;
};

/// Writes the gradient with respect to the environment, [6, S, S, 3]. gradients, bright: in the
/// order and with the values of prefilter_forward().
void prefilter_backward(const PrefilterBackend& backend, const ChainPlan& plan,
                        const std::vector<MeanGradient>& gradients, const std::int64_t* bright,
                        float* environment_gradient);

}  // namespace item3d
