// The resolution of a prior's name on the command line to its folder.
#pragma once

#include <filesystem>
#include <string>

namespace item3d {

/// Returns $XDG_DATA_HOME/item3d/priors, else ~/.local/share/item3d/priors: the folder of priors
/// that are called by name.
std::filesystem::path installed_priors_folder();

/// Returns the folder of a prior. `name` is one of
///   ""  or "embedded"        the prior that ships with item3d
///   a folder                 that folder
///   a name without a slash   the folder of this name in installed_priors_folder()
///   org/name[@revision]      a snapshot in the Hugging Face cache (hub_cache_folder())
///
/// in this order. Throws InputError that says where it searched and what to try.
std::filesystem::path find_prior(const std::string& name);

/// Returns the named network inside a prior (a sub-folder with a config.json or a
/// model_index.json); empty if the prior has none. "clip": CLIPModel for scores; "captioner": BLIP
/// for captions; "segmenter": CLIPSeg for regions; "instruct": an InstructPix2Pix pipeline.
std::filesystem::path find_in_prior(const std::filesystem::path& prior, const std::string& name);

}  // namespace item3d
