#include "item3d/models/ddim.h"
#include "parity.h"

namespace item3d::parity {
namespace {

void check_ddim(Case& golden, const std::string& prefix, DdimScheduler scheduler, double eta,
                int steps) {
    const torch::Tensor sample = golden.input("sample"), noise = golden.input("noise");
    golden.compare(prefix + "alphas_cumprod", scheduler.alphas_cumprod(), within::scheduler_step);
    if (golden.has("in.noise_timesteps")) {
        std::vector<torch::Tensor> noisy, velocities;
        const torch::Tensor timesteps = golden.input("noise_timesteps");
        for (std::int64_t i = 0; i < timesteps.size(0); ++i) {
            const torch::Tensor rows = timesteps[i].expand({sample.size(0)});
            noisy.push_back(scheduler.add_noise(sample, noise, rows));
            velocities.push_back(scheduler.get_velocity(sample, noise, rows));
        }
        golden.compare(prefix + "add_noise", torch::stack(noisy), within::scheduler_step);
        golden.compare(prefix + "get_velocity", torch::stack(velocities), within::scheduler_step);
    }

    scheduler.set_timesteps(steps);
    golden.compare(prefix + "timesteps", torch::tensor(scheduler.timesteps()), within::exact);
    golden.compare(prefix + "init_noise_sigma", torch::tensor({scheduler.init_noise_sigma()}),
                   within::scheduler_step);
    const torch::Tensor outputs = golden.input("model_outputs"), draws = golden.input("step_noise");
    std::vector<torch::Tensor> trajectory;
    torch::Tensor current = sample * scheduler.init_noise_sigma();
    for (int i = 0; i < steps; ++i) {
        current = scheduler.step(outputs[i], scheduler.timesteps()[i], current, eta, draws[i]);
        trajectory.push_back(current);
    }
    golden.compare(prefix + "prev_sample", torch::stack(trajectory), within::scheduler_step);
}

}  // namespace

void check_schedulers(Case& golden) {
    const Config meta = golden.meta();
    const int steps = meta.size("steps", 10);
    for (const std::string& config : meta.texts("configs", {})) {
        for (const std::string& kind : meta.texts("kinds", {})) {
            const std::string prefix = config + "." + kind + ".";
            const auto folder = golden.folder() / config / kind;
            const std::string name =
                Config::read(folder / "scheduler_config.json").text("_class_name", "");
            if (name != "DDIMScheduler") {
                golden.skip(prefix, name + " is not implemented");
                continue;
            }
            check_ddim(golden, prefix, DdimScheduler::load(folder), kind == "ddim_eta" ? 0.6 : 0.0,
                       steps);
        }
    }
}

}  // namespace item3d::parity
