// The prefiltered chain of split-sum lighting, on any backend. Every step is linear in the
// environment.
#pragma once

#include "item3d/render/prefilter/chain_plan.h"
#include "item3d/render/prefilter/cube_planes.h"
#include "item3d/render/prefilter/irradiance_sums.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Memory of the caller, on the backend, for the mean radiance of each texel. The mean radiance is
/// the sum of radiance divided by the sum of solid angle.
struct MeanMap {
    int size;               ///< S
    float* mean;            ///< [6, S, S, 3]
    float* inverse_weight;  ///< [S, S], the same for each face
};

/// Sets `maps`: first the irradiance map, of irradiance_size, then a map for each of plan.lobes.
/// `bright` [max_bright] receives the texels whose irradiance is summed exactly. environment: a map
/// of plan.sizes.front() texels.
void prefilter_forward(const PrefilterBackend& backend, const ChainPlan& plan,
                       const CubeMap& environment, const std::vector<MeanMap>& maps,
                       std::int64_t* bright);

/// Gradient with respect to MeanMap::mean, and the inverse_weight of the same map.
struct MeanGradient {
    CubeMap gradient;  ///< its values are null if there is no gradient
    const float* inverse_weight;
};

/// Writes the gradient with respect to the environment, [6, S, S, 3]. gradients: in the order of
/// the maps of prefilter_forward(). bright: the values that prefilter_forward() wrote.
void prefilter_backward(const PrefilterBackend& backend, const ChainPlan& plan,
                        const std::vector<MeanGradient>& gradients, const std::int64_t* bright,
                        float* environment_gradient);

}  // namespace item3d
