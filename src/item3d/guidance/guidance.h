// The interface of guidance: images and prompts in, gradient out, independent of meshes.
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

/// Weight omega(t) of a timestep: sqrt(abar)(1 - abar), 1/(1 - abar), 1 - abar, 1.
enum class Weighting { early, late, dreamfusion, uniform };

/// The way in which rdl adjusts its source embedding: by the denoising loss (learned_source.h), by
/// captions (caption_source.h), which are passed to Guidance::shift_source(), or not at all.
/// caption_paper: with the sign of the paper's formula.
enum class Adjustment { learned, caption, caption_paper, off };

/// Order of the iterations' timesteps, see scheduled_timestep().
enum class TimestepSchedule { uniform, anneal, dreamtime };

struct GuidanceOptions {
    std::string method = "rdl";               ///< one of guidance_methods()
    Adjustment adjust = Adjustment::learned;  ///< rdl only: adjustment of its direction
    float guidance_scale = 7.5f;              ///< w of classifier-free guidance
    /// Base of classifier-free guidance in place of the empty prompt; it cancels in rdl's
    /// direction. nfsd and csd have a separate term for it, and use default_negative_prompt() when
    /// it is empty.
    std::string negative_prompt;
    float anchor = 0.0f;  ///< lambda of anchored RDL: adds lambda (eps_target - eps)
    float adjust_learning_rate = 0.03f;
    int adjust_samples = 1;      ///< noises in each step of the learned source
    float min_timestep = 0.02f;  ///< as a fraction of the training timesteps
    float max_timestep = 0.98f;
    TimestepSchedule timestep_schedule = TimestepSchedule::uniform;
    Weighting weighting = Weighting::dreamfusion;  ///< of rdl, sds, nfsd and csd
    std::int64_t iterations = 1000;                ///< of the whole edit, for schedules
    std::uint64_t seed = 0;
};

/// Renders of one iteration. With several processes, this process has n of all N renders, possibly
/// none. The processes then exchange latents and rows of the U-Net's batch, so all must take each
/// step together.
struct GuidanceInput {
    at::Tensor images;  ///< [n, 3, H, W] sRGB in [0, 1]; the gradient is with respect to these
    SeenShape shape;    ///< used if the prior takes it
    /// [n, 3, H, W] the unedited model from the same cameras under the same light; undefined unless
    /// Guidance::needs_reference().
    at::Tensor reference = {};
    ProcessGroup processes = {};
    std::int64_t first = 0;  ///< index of the first image among the N
    std::int64_t total = 0;  ///< N; 0: n

    std::int64_t views() const { return total > 0 ? total : images.size(0); }
};

struct GuidanceOutput {
    /// [n, C, h, w] latents of the images, with the autograd graph to them, if any.
    at::Tensor latents;
    /// [n, C, h, w] g of docs/method.md, constant: call latents.backward(latents_gradient).
    at::Tensor latents_gradient;
    /// RMS over all N of the direction before weighting; curve of the report.
    float direction_length = 0;
    float source_loss = 0;      ///< rdl: denoising loss of the source, as in training
    std::int64_t timestep = 0;  ///< training timestep of all N images
    /// Seed of the noise: at::randn([N, C, h, w]) with a CPU generator of this seed.
    std::uint64_t noise_seed = 0;
    double seconds_encode = 0;
    double seconds_unet = 0;
};

/// A guidance method with its state.
class Guidance {
  public:
    virtual ~Guidance() = default;
    /// Computes one gradient. Noise and timesteps depend only on the options' seed and `iteration`.
    virtual GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) = 0;
    /// True if step() reads GuidanceInput::reference.
    virtual bool needs_reference() const { return false; }
    /// Sets the shift of the source prompt's embedding for subsequent steps (one row), for external
    /// adjustments. Ignored by methods without such a source.
    virtual void shift_source(const TextEmbedding& shift) { (void)shift; }
    /// Returns the current direction between the sentences; no value for methods without one.
    virtual std::optional<TextDirection> text_direction() const { return std::nullopt; }
    /// Returns the state for an exact resume; empty for methods without state.
    virtual NamedTensors state() const { return {}; }
    /// Restores state(). Throws InputError when a tensor is missing.
    virtual void load_state(const NamedTensors& state) { (void)state; }
};

/// A method of --guidance.
struct GuidanceKind {
    std::string name;
    std::string description;
    std::string cost;  ///< U-Net rows for each image in a step
};
const std::vector<GuidanceKind>& guidance_kinds();
/// Returns the names of guidance_kinds().
const std::vector<std::string>& guidance_methods();
/// Names of an enumeration's values, in order; parsing throws InputError on others.
const std::vector<std::string>& adjustment_names();
const std::vector<std::string>& weighting_names();
const std::vector<std::string>& timestep_schedule_names();
Adjustment parse_adjustment(const std::string& name);
Weighting parse_weighting(const std::string& name);
TimestepSchedule parse_timestep_schedule(const std::string& name);
/// True for caption and caption_paper.
bool adjusts_by_captions(Adjustment adjustment);
/// Returns the default negative prompt of nfsd and csd (Katzir et al. 2023).
const std::string& default_negative_prompt();

/// Makes a guidance method. Throws InputError on an unknown method or an empty prompt.
std::unique_ptr<Guidance> make_guidance(std::shared_ptr<const DiffusionModel> pipeline,
                                        const std::string& source_prompt,
                                        const std::string& target_prompt,
                                        const GuidanceOptions& options);

}  // namespace item3d
