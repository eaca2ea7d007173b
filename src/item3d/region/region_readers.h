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
    std::unique_ptr<Segmenter> segmenter;  ///< reads words; if null, the prior reads them
    PriorVocabulary vocabulary;            ///< of the network that reads words; may be open()
    std::shared_ptr<const DiffusionModel> prior;  ///< null if not needed
    /// Sentences for "auto", as the prior reads them; empty if there are none.
    std::string from, to;
};

/// True if a selector of the request uses the prior: "auto", or words without a segmenter.
bool needs_prior(const RegionRequest& request, bool has_segmenter);

/// Returns the prompts that the prior must encode to read the request's words without a segmenter,
/// for RunNeeds.
std::vector<std::string> prompts_of_words(const RegionRequest& request);

/// Does nothing unless a selector of the request is by words. Loads the segmenter in `folder` and
/// the vocabulary of the prior to which it belongs; if `folder` is empty, only the vocabulary in
/// `prior`. The caller sets the prior itself and the sentences. Throws InputError.
RegionReaders load_readers(const RegionRequest& request, const std::filesystem::path& folder,
                           const std::filesystem::path& prior, at::Device device);

}  // namespace item3d
