// SyncMVD (Liu et al. 2023, "Text-Guided Texturing by Synchronized Multi-View Diffusion"). It
// denoises all views together, and merges their predictions in a latent texture. See
// docs/compare.md for the differences from the published code.
#pragma once

#include "item3d/baselines/view_painter.h"

namespace item3d {

/// Returns the weights [T] of the texels in a view that sees them at `cosine` [T]. The weight is
/// cosine^e, where e rises from 0 to 6 over the steps; it is 0 for invisible texels.
at::Tensor view_weight(const at::Tensor& cosine, int step, int steps);

/// Weighted means of several views.
struct MergedTexels {
    at::Tensor values;
    at::Tensor known;
};
MergedTexels merge_views(const std::vector<at::Tensor>& values,
                         const std::vector<at::Tensor>& weights);

class SyncMvd : public ViewPainter {
  public:
    SyncMvd(const PaintingScene& scene, const PainterOptions& options);
    static std::int64_t step_count(const PainterOptions& options);
    /// Does a step of denoising; the last one decodes the views and paints them.
    void step(std::int64_t index) override;
    void finish() override;
    NamedTensors state() const override;
    void load_state(const CheckpointReader& reader) override;

  private:
    /// A view at the resolution of the latents.
    struct LatentView {
        SideView view;
        Raster raster;
        Surface surface;
        TexelView texels;    ///< texels of the latent texture
        at::Tensor covered;  ///< [1, 1, h, w]
    };
    void begin();
    at::Tensor background(std::int64_t index) const;
    at::Tensor texture_to_views(const at::Tensor& behind) const;
    at::Tensor noise(at::IntArrayRef sizes, BaselineDraw draw, std::uint64_t index) const;
    void paint_views(const at::Tensor& latents);

    std::vector<LatentView> views_;
    at::Tensor conditions_;      ///< [N, c, h, w]; undefined if the prior has no condition
    at::Tensor latent_texture_;  ///< [L, C] noisy latents of the L latent texels
    at::Tensor view_latents_;    ///< [N, C, h, w] noisy latents, after the views separate
};

}  // namespace item3d
