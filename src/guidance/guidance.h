// Pictures and prompts in, gradient out. Knows images, not meshes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "item3d/core/random.h"
#include "item3d/models/pipeline.h"

namespace item3d {

/// omega(t): how much a timestep counts.
enum class Weighting { early, late, dreamfusion, uniform };

struct GuidanceOptions {
    std::string method = "rdl";       ///< "sds" or "rdl"
    std::string adjust = "learned";   ///< "off" or "learned"; rdl only
    float guidance_scale = 7.5f;      ///< w of classifier-free guidance
    float anchor = 0.0f;              ///< lambda of anchored RDL: adds lambda (eps_target - eps)
    float adjust_learning_rate = 0.03f;
    float min_timestep = 0.02f;       ///< as a part of the training timesteps
    float max_timestep = 0.98f;
    Weighting weighting = Weighting::dreamfusion;
    std::uint64_t seed = 0;
};

/// Renders of one iteration.
struct GuidanceInput {
    torch::Tensor images;  ///< [N, 3, H, W] sRGB in [0, 1]; the gradient is with respect to these
    torch::Tensor depth;   ///< [N, H, W] z-depth, 0: background; used where the U-Net takes depth
};

struct GuidanceOutput {
    torch::Tensor latents_gradient;  ///< [N, C, h, w]: g of DESIGN.md section 2, constant
    torch::Tensor latents;           ///< [N, C, h, w] with graph: backward(latents, latents_gradient)
    float direction_length = 0;      ///< RMS of (eps_target - eps_source), the report's curve
    float adjustment_loss = 0;       ///< denoising loss of the learned source
    double seconds_encode = 0;
    double seconds_unet = 0;
};

/// One of the methods, with its state (the learned source embedding and its optimiser).
class Guidance {
  public:
    virtual ~Guidance() = default;
    virtual GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) = 0;
    /// State that a checkpoint must hold, as named tensors; empty where there is none.
    virtual std::vector<std::pair<std::string, torch::Tensor>> state() const = 0;
    virtual void load_state(const std::vector<std::pair<std::string, torch::Tensor>>& state) = 0;
};

/// Throws InputError on an unknown method, weighting or adjustment.
std::unique_ptr<Guidance> make_guidance(std::shared_ptr<const Pipeline> pipeline,
                                        const std::string& source, const std::string& target,
                                        const GuidanceOptions& options);

}  // namespace item3d
