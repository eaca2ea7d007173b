// Networks and sentences for the selectors by words and for "auto".
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/region/region.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct RegionReaders {
    std::unique_ptr<Segmenter> segmenter;         ///< for words; null: the prior is used
    PriorVocabulary vocabulary;                   ///< of the network for words; may be open
    std::shared_ptr<const DiffusionModel> prior;  ///< null: not needed
    std::string from, to;  ///< sentences as the prior reads them, for auto; empty: none
};

/// True if a selector of the request uses the prior: auto, or words without a segmenter.
bool needs_prior(const RegionRequest& request, bool has_segmenter);

/// Returns the prompts that the prior encodes for words without a segmenter, for RunNeeds.
std::vector<std::string> prompts_of_words(const RegionRequest& request);

/// Loads the segmenter in `folder` if a selector of the request is by words, with the vocabulary of
/// its prior; without a folder, the vocabulary in `prior`. The caller sets the prior itself and the
/// sentences. Throws InputError.
RegionReaders load_readers(const RegionRequest& request, const std::filesystem::path& folder,
                           const std::filesystem::path& prior, at::Device device);

}  // namespace item3d
