// The base class of methods that paint the texels of a model view after view.
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
    int steps = 0;  ///< sampling steps; 0: the method's default
    int views = 0;  ///< number of painted views; 0: the method's default
    float cfg = 7.5f;
    std::uint64_t seed = 0;
};

/// A running method. Its steps run in order; their number is known in advance.
class ViewPainter {
  public:
    /// scene: must outlive the painter.
    ViewPainter(const PaintingScene& scene, const PainterOptions& options);
    virtual ~ViewPainter() = default;

    /// Runs step `index`: paints a view, or does a denoising step. Throws Interrupted.
    virtual void step(std::int64_t index) = 0;
    /// Fills unpainted texels. Must be called after the last step.
    virtual void finish() = 0;

    /// Returns the texels' colours, [T, 3] sRGB. Texels that the edit does not change have their
    /// unedited colours, and texels that are not painted yet are grey.
    virtual at::Tensor colors() const;
    /// Returns the finished views, [1, 3, R, R] sRGB each.
    const std::vector<at::Tensor>& images() const { return images_; }

    /// Returns the state for an exact resume.
    virtual NamedTensors state() const;
    virtual void load_state(const CheckpointReader& reader);

  protected:
    /// Returns the prior with a view's prompt, which names the side if the prior understands sides.
    GuidedModel guided(const ViewRender& render, const at::Tensor& latents) const;
    /// Returns an image's latents.
    at::Tensor encode(const at::Tensor& image) const;
    /// Returns the image of latents, [1, 3, R, R] in [0, 1].
    at::Tensor decode(const at::Tensor& latents) const;
    /// Blends an image's colours into the texels with weight `share` [T].
    void paint(const ViewRender& render, const at::Tensor& image, const at::Tensor& share);
    bool is_painted_at_all() const;

    const PaintingScene& scene_;
    PainterOptions options_;
    at::Tensor colors_;   ///< [T, 3]
    at::Tensor painted_;  ///< [T] largest cosine of the views that painted a texel; 0: unpainted
    std::vector<at::Tensor> images_;
};

/// Returns the prompt of a view: "PROMPT, front view" if the prior understands sides, else the
/// unchanged prompt.
std::string prompt_of_side(const PaintingScene& scene, const std::string& side);
/// Returns all prompts that any painter encodes with the prior.
std::vector<std::string> painting_prompts(const std::string& prompt,
                                          const std::string& negative_prompt);

}  // namespace item3d
