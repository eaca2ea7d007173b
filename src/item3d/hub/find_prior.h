// What a prior is called on the command line, and where it lies.
#pragma once

#include <filesystem>
#include <string>

namespace item3d {

/// $XDG_DATA_HOME/item3d/priors, else ~/.local/share/item3d/priors: folders there are priors that
/// can be called by their names.
std::filesystem::path installed_priors_folder();

/// The folder of a prior. `name` is one of
///   ""  or "embedded"        the one that ships with item3d
///   a folder                 itself
///   a name without a slash   a folder of installed_priors_folder()
///   org/name[@revision]      a snapshot in the Hugging Face cache (hub_cache_folder())
/// in this order. Throws InputError that says where was looked and what to try.
std::filesystem::path find_prior(const std::string& name);

/// The network of that name that a prior brings along (a sub-folder with a config.json or a
/// model_index.json); empty where it brings none. "clip": CLIPModel for scores; "captioner": BLIP
/// for captions; "segmenter": CLIPSeg for regions; "instruct": an InstructPix2Pix pipeline.
std::filesystem::path find_in_prior(const std::filesystem::path& prior, const std::string& name);

}  // namespace item3d
