// DDIM (Song et al. 2021); make_sampler() makes it.
#pragma once

#include "item3d/networks/diffusion/samplers/sampler.h"

#include <memory>

namespace item3d {

std::unique_ptr<Sampler> make_ddim(const NoiseSchedule& schedule, const SamplerOptions& options);

}  // namespace item3d
