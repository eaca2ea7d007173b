// The loading of an edit's networks (prior, captioner, inpainter), and the choice of a memory mode.
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

/// Returns the captioner that adjusts the direction; null if the plan needs no captioner. Throws
/// InputError if the plan needs a captioner and the request names none.
std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       at::ScalarType precision);

/// Device, precision and memory mode of a prior.
struct PriorUse {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool low_memory = false;
};

/// The requirements of all edits that share a prior.
struct PriorNeeds {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool any_sentence = false;  ///< a captioner will add sentences during the edit
    /// All known sentences, as the prior reads them, except the default negative prompt.
    std::vector<std::string> sentences;
    bool decoder = false;  ///< an edit will decode latents
};

/// Returns the folder of the networks that the request's method runs. It is the prior, or the
/// pipeline that edits by instructions.
std::filesystem::path networks_folder(const EditRequest& request);

/// Adds the sentences and the decoder that an edit with this plan needs to `needs`.
void add_needs(PriorNeeds& needs, const EditRequest& request, const EditPlan& plan,
               const PriorVocabulary& vocabulary);

/// Loads the networks, with the extras (LoRA, ControlNet, ...) of the request's plan.
std::shared_ptr<DiffusionModel> load_networks(const EditRequest& request, const PriorNeeds& needs);

/// Configures a loaded prior for one edit. Warns of words in the edit's sentences that the prior
/// drops, because they exceed its text length.
void make_prior_ready(DiffusionModel& prior, const EditPlan& plan, bool low_memory);

/// Returns the inpainting network for methods that paint views; null if the request names none. to:
/// the target sentence as the prior reads it. Throws InputError if the network does not inpaint.
std::shared_ptr<const DiffusionModel> load_inpainter(const EditRequest& request, at::Device device,
                                                     at::ScalarType precision,
                                                     const std::string& to);

/// True if the edit should save memory at the cost of time. `--memory low` and `--memory high`
/// decide it. For `--memory auto`, the function compares an estimate, from the headers of the
/// prior's files, with the free memory; if it chooses low memory, it logs that. Warns if the
/// estimate for the chosen mode exceeds the free memory. is_loaded: true if the prior's weights are
/// in memory already. Throws ResourceError if the weights alone do not fit, and InputError for any
/// other value of `--memory`.
bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device,
                      bool is_loaded = false);

}  // namespace item3d
