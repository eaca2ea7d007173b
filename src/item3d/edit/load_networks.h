// The networks of an edit: the prior, the captioner, and whether they fit into memory.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/networks/vocabulary.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// The captioner that adjusts the direction; null where the plan asks none. Throws InputError where
/// it is to be had and none was given.
std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       at::ScalarType precision);

/// How an edit runs a prior.
struct PriorUse {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool low_memory = false;
};

/// What edits that share a prior ask of it.
struct PriorNeeds {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool any_sentence = false;  ///< some are not known yet: a captioner will say them
    /// All that are known, as the prior reads them, but the default negative prompt.
    std::vector<std::string> sentences;
    bool decoder = false;  ///< latents will be decoded
};

/// The folder whose networks the request's method runs: the prior, or what edits by instructions.
std::filesystem::path networks_folder(const EditRequest& request);

/// Adds the sentences and the decoder that an edit by `plan` uses; all else as the request says.
void add_needs(PriorNeeds& needs, const EditRequest& request, const EditPlan& plan,
               const PriorVocabulary& vocabulary);

/// Loads the networks with what the request's plan adds to them.
std::shared_ptr<DiffusionModel> load_networks(const EditRequest& request, const PriorNeeds& needs);

/// Sets a loaded prior up for one edit; warns of words of its sentences that the prior cuts off.
void make_prior_ready(DiffusionModel& prior, const EditPlan& plan, bool low_memory);

/// The network that inpaints for methods that paint views; null where the request names none. to:
/// as the prior reads it. Throws InputError where it is none.
std::shared_ptr<const DiffusionModel> load_inpainter(const EditRequest& request, at::Device device,
                                                     at::ScalarType precision,
                                                     const std::string& to);

/// Whether to trade time for memory, as `--memory` says. "high" and "low" say it; "auto"
/// looks at the prior's headers and at what is free, and says what it chose where that is not the
/// usual. is_loaded: the prior's weights are in memory. Warns where even the low estimate does not
/// fit. Throws ResourceError when the weights alone do not, InputError on another word.
bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device,
                      bool is_loaded = false);

}  // namespace item3d
