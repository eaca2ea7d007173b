// Default sampling options of a prior.
#pragma once

#include "item3d/networks/diffusion/generate.h"

#include <filesystem>
#include <string>

namespace item3d {

/// Returns options with scheduler, steps and guidance scale: those that the folder's prior.json
/// recommends ("generate": {"steps", "guidance_scale"}), or else the usual values for the scheduler
/// and the model. scheduler: a name of sampler_kinds(), or empty for the folder's own scheduler.
/// The recommended steps apply only to the folder's own scheduler. Throws InputError for an invalid
/// prior.json.
GenerateOptions generate_defaults(const std::filesystem::path& folder, const DiffusionModel& model,
                                  const std::string& scheduler = "");

}  // namespace item3d
