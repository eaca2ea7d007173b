// The interface of guidance. A guidance method takes images and prompts and computes a gradient for
// the images. It knows nothing of meshes.
//
// Comments in this folder use the symbols of docs/method.md:
//   z, z_t     the latents of an image, and these latents with the noise of timestep t
//   eps        the noise
//   abar_t     the cumulative alpha of the schedule: z_t = sqrt(abar_t) z + sqrt(1 - abar_t) eps
//   y          a prompt: y_source, y_target, negative, or empty
//   eps(y)     the U-Net's prediction of the noise in z_t for a prompt; in full eps(z_t, y)
//   eps^w(y)   eps(empty) + w (eps(y) - eps(empty)): classifier-free guidance of scale w (--cfg)
//   omega(t)   the weight of a timestep (Weighting)
//   g          the gradient with respect to z
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

/// Weight omega(t) of a timestep. In the order of the values it is sqrt(abar) (1 - abar), 1 / (1 -
/// abar), 1 - abar, and 1, with abar = abar_t.
enum class Weighting { early, late, dreamfusion, uniform };

/// The way in which rdl adjusts its source embedding. learned: by the denoising loss
/// (learned_source.h); caption: by captions (caption_source.h), which are passed to
/// Guidance::shift_source(); caption_paper: likewise, with the sign of the paper's formula; off:
/// not at all.
enum class Adjustment { learned, caption, caption_paper, off };

/// Order of the iterations' timesteps (scheduled_timestep()).
enum class TimestepSchedule { uniform, anneal, dreamtime };

struct GuidanceOptions {
    std::string method = "rdl";               ///< one of guidance_methods()
    Adjustment adjust = Adjustment::learned;  ///< adjustment of the source embedding; only for rdl
    float guidance_scale = 7.5f;              ///< w of classifier-free guidance
    /// The negative prompt. It replaces the empty prompt in eps^w, and cancels in rdl's direction.
    /// nfsd and csd have a separate term for it, and use default_negative_prompt() if it is empty.
    std::string negative_prompt;
    float anchor = 0.0f;  ///< lambda of rdl's anchor (rdl.h); only for rdl
    float adjust_learning_rate = 0.03f;
    int adjust_samples = 1;      ///< number of noises in a step of the learned source
    float min_timestep = 0.02f;  ///< as a fraction of the training timesteps
    float max_timestep = 0.98f;
    TimestepSchedule timestep_schedule = TimestepSchedule::uniform;
    Weighting weighting = Weighting::dreamfusion;  ///< only for rdl, sds, nfsd and csd
    std::int64_t iterations = 1000;  ///< number of the whole edit's iterations, for schedules
    std::uint64_t seed = 0;
};

/// The renders of one iteration. If several processes run the edit, this process has n of all N
/// renders; n may be 0. The processes then exchange latents and rows of the U-Net's batch, so all
/// of them must take each step together.
struct GuidanceInput {
    at::Tensor images;  ///< [n, 3, H, W] sRGB in [0, 1]; the gradient is with respect to these
    SeenShape shape;    ///< of the images; used if the prior has a condition
    /// [n, 3, H, W] renders of the unedited model from the same cameras in the same light. May be
    /// undefined if Guidance::needs_reference() is false.
    at::Tensor reference = {};
    ProcessGroup processes = {};
    std::int64_t first = 0;  ///< index of the first of the n images among the N
    std::int64_t total = 0;  ///< N; 0 means that N is n

    std::int64_t views() const { return total > 0 ? total : images.size(0); }
};

struct GuidanceOutput {
    /// [n, C, h, w] latents of the images. They have the autograd graph to the images, if the
    /// images have one.
    at::Tensor latents;
    /// [n, C, h, w] the gradient g, a constant. The caller runs latents.backward(latents_gradient).
    at::Tensor latents_gradient;
    /// Root mean square, over all N images, of the direction before weighting. The report shows its
    /// curve.
    float direction_length = 0;
    float source_loss = 0;      ///< denoising loss of rdl's learned source
    std::int64_t timestep = 0;  ///< training timestep of all N images
    /// Seed of the noise. The noise is at::randn([N, C, h, w]) with a CPU generator of this seed.
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
    /// Sets the shift of the source prompt's embedding (one row) for the following steps, if the
    /// caller adjusts the source. Methods without a source that can be shifted ignore it.
    virtual void shift_source(const TextEmbedding& shift) { (void)shift; }
    /// Returns the current direction from the source sentence to the target sentence. Methods
    /// without such a direction return no value.
    virtual std::optional<TextDirection> text_direction() const { return std::nullopt; }
    /// Returns the state for an exact resume; empty for methods without state.
    virtual NamedTensors state() const { return {}; }
    /// Restores state(). Throws InputError when a tensor is missing.
    virtual void load_state(const NamedTensors& state) { (void)state; }
};

/// A value of the option --guidance.
struct GuidanceKind {
    std::string name;
    std::string description;
    std::string cost;  ///< number of U-Net evaluations for each image in a step
};
const std::vector<GuidanceKind>& guidance_kinds();
/// Returns the names of guidance_kinds().
const std::vector<std::string>& guidance_methods();
/// The names of the enumerations' values, in their order. The parsers throw InputError for any
/// other name.
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
