#include "item3d/networks/diffusion/scheduler_config.h"

#include "item3d/networks/diffusion/noise_schedule.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

ITEM3D_FUZZ_TARGET(scheduler_config, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto folder = fuzz::as_files("scheduler_config", {"scheduler_config.json"},
                                           fuzz::as_text(data, size));
        const NoiseSchedule schedule = NoiseSchedule::load(folder);
        for (const SamplerKind& kind : sampler_kinds())
            schedule.config().with_sampler(kind.name).to_json();
    });
}
