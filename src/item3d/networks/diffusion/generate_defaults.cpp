#include "item3d/networks/diffusion/generate_defaults.h"

#include "item3d/core/config.h"

namespace item3d {

GenerateOptions generate_defaults(const std::filesystem::path& folder, const DiffusionModel& model,
                                  const std::string& scheduler) {
    GenerateOptions options;
    const std::string own = model.schedule().config().sampler_name();
    options.scheduler = scheduler.empty() ? own : scheduler;
    for (const SamplerKind& kind : sampler_kinds())
        if (kind.name == options.scheduler) options.steps = kind.usual_steps;
    options.guidance_scale = model.is_sdxl() ? 5.0f : 7.5f;
    if (!std::filesystem::exists(folder / "prior.json")) return options;
    const Config config = Config::read(folder / "prior.json");
    const Config defaults(
        config.has("generate") ? config.json().at("generate") : nlohmann::json::object(),
        config.subject() + ": generate");
    if (options.scheduler == own) options.steps = defaults.size("steps", options.steps);
    options.guidance_scale =
        static_cast<float>(defaults.number("guidance_scale", options.guidance_scale));
    return options;
}

}  // namespace item3d
