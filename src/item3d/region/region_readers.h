// The networks that selectors by meaning ask, and what they are asked with.
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
    std::unique_ptr<Segmenter> segmenter;         ///< for words; null: the prior is asked
    PriorVocabulary vocabulary;                   ///< of what is asked for words; may be open
    std::shared_ptr<const DiffusionModel> prior;  ///< null: none is needed
    std::string from, to;  ///< sentences as the prior reads them, for auto; empty: not given
};

/// Whether a selector of the request asks the prior: auto, and words where there is no segmenter.
bool needs_prior(const RegionRequest& request, bool has_segmenter);

/// Prompts that the prior is asked for words where there is no segmenter, for RunNeeds.
std::vector<std::string> prompts_of_words(const RegionRequest& request);

/// The segmenter in `folder`, where a selector of the request is by words, with the vocabulary of
/// the prior that it belongs to; without a folder, the vocabulary in `prior`. The prior itself and
/// the sentences are left to the caller. Throws InputError.
RegionReaders load_readers(const RegionRequest& request, const std::filesystem::path& folder,
                           const std::filesystem::path& prior, at::Device device);

}  // namespace item3d
