// Text2Tex (Chen et al. 2023, "Text-driven Texture Synthesis via Diffusion Models"), with the
// settings of its published code, on this project's prior and renderer. See docs/compare.md for the
// differences.
#pragma once

#include "item3d/baselines/text2tex_views.h"
#include "item3d/baselines/view_painter.h"

#include <optional>

namespace item3d {

class Text2Tex : public ViewPainter {
  public:
    Text2Tex(const PaintingScene& scene, const PainterOptions& options);
    static std::int64_t step_count(const PainterOptions& options);
    void step(std::int64_t index) override;
    void finish() override;
    NamedTensors state() const override;
    void load_state(const CheckpointReader& reader) override;

  private:
    GenerationMask look(const ViewRender& render) const;
    std::size_t next_candidate();
    /// Samples the part of a view where `mask` is set, and paints the texels there.
    at::Tensor draw(const ViewRender& render, const at::Tensor& mask, bool with_background,
                    double strength, std::uint64_t noise);
    void find_best();

    at::Tensor best_;   ///< [T] largest cosine over all views of view_lists.h's two lists
    at::Tensor taken_;  ///< [candidates] bool
    std::vector<ViewRender> candidates_;  ///< small renders, made on demand
};

}  // namespace item3d
