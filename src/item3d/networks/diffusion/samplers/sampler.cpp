#include "item3d/networks/diffusion/samplers/sampler.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/samplers/ddim.h"
#include "item3d/networks/diffusion/samplers/ddpm.h"
#include "item3d/networks/diffusion/samplers/dpmpp_2m.h"
#include "item3d/networks/diffusion/samplers/euler.h"
#include "item3d/networks/diffusion/samplers/pndm.h"

namespace item3d {

double Sampler::alpha_at(std::int64_t timestep) const {
    return schedule_.alphas_cumprod()[timestep].item<double>();
}

int max_steps(const SchedulerConfig& config) {
    // DPM-Solver++ with n steps divides the schedule into n + 1 parts.
    return config.num_train_timesteps - (config.method == SamplerMethod::dpmpp_2m ? 1 : 0);
}

std::unique_ptr<Sampler> make_sampler(const NoiseSchedule& schedule,
                                      const SamplerOptions& options) {
    const SchedulerConfig& config = schedule.config();
    ITEM3D_CHECK(options.steps >= 1 && options.steps <= max_steps(config),
                 "steps must be 1 to max_steps()");
    ITEM3D_CHECK(options.skip >= 0 && options.skip < options.steps, "no step is left");
    ITEM3D_CHECK(options.eta == 0 || config.method == SamplerMethod::ddim, "only DDIM has eta");
    switch (config.method) {
        case SamplerMethod::ddim:
            return make_ddim(schedule, options);
        case SamplerMethod::ddpm:
            return make_ddpm(schedule, options);
        case SamplerMethod::euler:
            return make_euler(schedule, options);
        case SamplerMethod::dpmpp_2m:
            return make_dpmpp_2m(schedule, options);
        case SamplerMethod::pndm:
            return make_pndm(schedule, options);
    }
    ITEM3D_CHECK(false, "unknown method");
}

}  // namespace item3d
