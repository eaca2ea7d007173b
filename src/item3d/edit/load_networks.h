// The networks of an edit: the prior, the captioner, and whether they fit into memory.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/captioner.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// The captioner that adjusts the direction; null where the plan asks none. Throws InputError where
/// it is to be had and none was given.
std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       at::ScalarType precision);

/// The part of a scene that loading a prior depends on.
struct PriorNeeds {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool any_sentence = false;  ///< some are not known yet: a captioner will say them
    bool low_memory = false;
    std::string from, to;              ///< as the prior reads them
    std::vector<std::string> prompts;  ///< what else it will be asked
};

/// Loads the prior with what the settings add to it; warns of words of the sentences that it cuts
/// off.
std::shared_ptr<const DiffusionModel> load_prior(const EditRequest& request,
                                                 const PriorNeeds& needs);

/// The network that inpaints for methods that paint views; null where the request names none. to:
/// as the prior reads it. Throws InputError where it is none.
std::shared_ptr<const DiffusionModel> load_inpainter(const EditRequest& request, at::Device device,
                                                     at::ScalarType precision,
                                                     const std::string& to);

/// Whether to trade time for memory, as `--memory` says. "high" and "low" say it; "auto"
/// looks at the prior's headers and at what is free, and says what it chose where that is not the
/// usual. Warns where even the low estimate does not fit. Throws ResourceError when the weights
/// alone do not, InputError on another word.
bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device);

}  // namespace item3d
