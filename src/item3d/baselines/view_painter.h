// Methods that paint the texels of a model view after view: what they have in common.
#pragma once

#include "item3d/baselines/masked_sampling.h"
#include "item3d/baselines/painting_scene.h"
#include "item3d/tensors/checkpoint.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct PainterOptions {
    int steps = 0;  ///< of sampling; 0: the method's own number
    int views = 0;  ///< that are painted; 0: the method's own number
    float cfg = 7.5f;
    std::uint64_t seed = 0;
};

/// A method in progress. Its steps are taken in order, and their number is known before.
class ViewPainter {
  public:
    /// scene must outlive this.
    ViewPainter(const PaintingScene& scene, const PainterOptions& options);
    virtual ~ViewPainter() = default;

    /// Takes step `index`: paints a view, or goes a step of denoising. Throws Interrupted.
    virtual void step(std::int64_t index) = 0;
    /// Call behind the last step: texels that no view painted.
    virtual void finish() = 0;

    /// [T, 3] sRGB: what is painted so far, on what was there.
    virtual at::Tensor colors() const;
    /// Edited views so far, [1, 3, R, R] sRGB each.
    const std::vector<at::Tensor>& pictures() const { return pictures_; }

    /// What an exact resume needs.
    virtual NamedTensors state() const;
    virtual void load_state(const CheckpointReader& reader);

  protected:
    /// The prompt of a view, with its side where the prior understands that.
    GuidedModel guided(const ViewRender& render, const at::Tensor& latents) const;
    /// The picture's latents.
    at::Tensor encode(const at::Tensor& picture) const;
    /// [1, 3, R, R] in [0, 1].
    at::Tensor decode(const at::Tensor& latents) const;
    /// Replaces colours by those of a picture where `share` [T] is above 0, by as much.
    void paint(const ViewRender& render, const at::Tensor& picture, const at::Tensor& share);
    bool is_painted_at_all() const;

    const PaintingScene& scene_;
    PainterOptions options_;
    at::Tensor colors_;   ///< [T, 3]
    at::Tensor painted_;  ///< [T] cosine at which a texel was painted best; 0: not yet
    std::vector<at::Tensor> pictures_;
};

/// The prompt of a view: "PROMPT, front view", or as it is.
std::string prompt_of_side(const PaintingScene& scene, const std::string& side);
/// All prompts that any painter asks the prior's encoder for.
std::vector<std::string> painting_prompts(const std::string& prompt,
                                          const std::string& negative_prompt);

}  // namespace item3d
