// The search for a prior's folder by the name given on the command line.
#pragma once

#include <filesystem>
#include <string>

namespace item3d {

/// Returns the folder of the priors that can be given by name: $XDG_DATA_HOME/item3d/priors, or
/// ~/.local/share/item3d/priors if XDG_DATA_HOME is not set.
std::filesystem::path installed_priors_folder();

/// Returns the folder of a prior. The first fitting one of these meanings of `name` counts:
///   ""  or "embedded"        the prior that ships with item3d
///   a folder                 that folder
///   a name without a slash   the folder of this name in installed_priors_folder()
///   org/name[@revision]      a snapshot in the Hugging Face cache (hub_cache_folder())
///
/// Throws InputError that says where the function searched and what to try.
std::filesystem::path find_prior(const std::string& name);

/// Returns the folder of a named network inside a prior, which is a sub-folder with a config.json
/// or a model_index.json. Empty if the prior has none. The names are "clip" (a CLIPModel for
/// scores), "captioner" (BLIP for captions), "segmenter" (CLIPSeg for regions) and "instruct" (an
/// InstructPix2Pix pipeline).
std::filesystem::path find_in_prior(const std::filesystem::path& prior, const std::string& name);

}  // namespace item3d
