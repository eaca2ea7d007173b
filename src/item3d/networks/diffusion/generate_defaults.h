// How a prior draws best, by its own word.
#pragma once

#include "item3d/networks/diffusion/generate.h"

#include <filesystem>
#include <string>

namespace item3d {

/// Scheduler, steps and guidance scale: what the folder's prior.json recommends ("generate":
/// {"steps", "guidance_scale"}) where it has one, else what is usual for the scheduler and the
/// model. scheduler: a name of sampler_kinds(); empty: the folder's own, the only one that the
/// recommended steps are for. Throws InputError for a prior.json that can't be understood.
GenerateOptions generate_defaults(const std::filesystem::path& folder, const DiffusionModel& model,
                                  const std::string& scheduler = "");

}  // namespace item3d
