// Pictures and prompts in, gradient out. Knows images, not meshes.
#pragma once

#include "item3d/guidance/text_direction.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// omega(t), how much a timestep counts: sqrt(abar)(1 - abar), 1/(1 - abar), 1 - abar, 1.
enum class Weighting { early, late, dreamfusion, uniform };

/// What moves rdl's source: its denoising loss (learned_source.h), captions (caption_source.h),
/// which whoever makes them hands to Guidance::shift_source(), or nothing. caption_paper: with the
/// sign of the paper's formula.
enum class Adjustment { learned, caption, caption_paper, off };

/// How the timesteps of the iterations follow one another, see scheduled_timestep().
enum class TimestepSchedule { uniform, anneal, dreamtime };

struct GuidanceOptions {
    std::string method = "rdl";               ///< one of guidance_methods()
    Adjustment adjust = Adjustment::learned;  ///< only rdl has a direction to adjust
    float guidance_scale = 7.5f;              ///< w of classifier-free guidance
    /// What classifier-free guidance starts from, in place of the empty prompt; it cancels in rdl's
    /// direction. nfsd and csd have a term of its own for it, default_negative_prompt() when empty.
    std::string negative_prompt;
    float anchor = 0.0f;  ///< lambda of anchored RDL: adds lambda (eps_target - eps)
    float adjust_learning_rate = 0.03f;
    int adjust_samples = 1;      ///< noises that each step of the learned source looks at
    float min_timestep = 0.02f;  ///< as a fraction of the training timesteps
    float max_timestep = 0.98f;
    TimestepSchedule timestep_schedule = TimestepSchedule::uniform;
    Weighting weighting = Weighting::dreamfusion;  ///< of rdl, sds, nfsd and csd
    std::int64_t iterations = 1000;  ///< of the whole edit: what changes in its course looks here
    std::uint64_t seed = 0;
};

/// Renders of one iteration. Where several processes share it out, those of this one alone: n of N,
/// which may be none; latents and the U-Net's rows are then exchanged, so all take each step
/// together.
struct GuidanceInput {
    at::Tensor images;  ///< [n, 3, H, W] sRGB in [0, 1]; what the gradient is with respect to
    SeenShape shape;    ///< read where the prior takes it
    /// [n, 3, H, W] the unedited model from the same cameras in the same light; undefined unless
    /// Guidance::needs_reference().
    at::Tensor reference = {};
    ProcessGroup processes = {};
    std::int64_t first = 0;  ///< place of the first image among the N
    std::int64_t total = 0;  ///< N; 0: n

    std::int64_t views() const { return total > 0 ? total : images.size(0); }
};

struct GuidanceOutput {
    /// [n, C, h, w] with its graph back to the images, where there are any.
    at::Tensor latents;
    /// [n, C, h, w] g of docs/method.md, a constant: call latents.backward(latents_gradient).
    at::Tensor latents_gradient;
    /// RMS of the direction before weighting, of all N; the report's curve.
    float direction_length = 0;
    float source_loss = 0;  ///< rdl: denoising loss of the source, as the model was trained
    double seconds_encode = 0;
    double seconds_unet = 0;
};

/// A guidance method with its state.
class Guidance {
  public:
    virtual ~Guidance() = default;
    /// Noise and timesteps depend on the options' seed and `iteration` alone.
    virtual GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) = 0;
    /// Whether step() reads GuidanceInput::reference.
    virtual bool needs_reference() const { return false; }
    /// What is to be added to the source prompt's embedding from the next step on (one row), for
    /// adjustments that are made outside. Methods without such a source leave it.
    virtual void shift_source(const TextEmbedding& shift) { (void)shift; }
    /// Where the direction between the sentences points now; no value for methods without one.
    virtual std::optional<TextDirection> text_direction() const { return std::nullopt; }
    /// What a checkpoint must hold for an exact resume; empty for methods without state.
    virtual NamedTensors state() const { return {}; }
    /// Takes back what state() gave. Throws InputError when a tensor is missing.
    virtual void load_state(const NamedTensors& state) { (void)state; }
};

/// What --guidance offers.
struct GuidanceKind {
    std::string name;
    std::string description;
    std::string cost;  ///< rows of the U-Net for each picture of a step
};
const std::vector<GuidanceKind>& guidance_kinds();
/// Their names.
const std::vector<std::string>& guidance_methods();
/// Names of an enumeration's values, in their order; parsing throws InputError on others.
const std::vector<std::string>& adjustment_names();
const std::vector<std::string>& weighting_names();
const std::vector<std::string>& timestep_schedule_names();
Adjustment parse_adjustment(const std::string& name);
Weighting parse_weighting(const std::string& name);
TimestepSchedule parse_timestep_schedule(const std::string& name);
/// True of caption and caption_paper.
bool adjusts_by_captions(Adjustment adjustment);
/// What nfsd and csd push away from when nothing else is said (Katzir et al. 2023).
const std::string& default_negative_prompt();

/// Throws InputError on an unknown method or an empty prompt.
std::unique_ptr<Guidance> make_guidance(std::shared_ptr<const DiffusionModel> pipeline,
                                        const std::string& source_prompt,
                                        const std::string& target_prompt,
                                        const GuidanceOptions& options);

}  // namespace item3d
