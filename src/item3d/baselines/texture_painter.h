// TEXTure (Richardson et al. 2023, "TEXTure: Text-Guided Texturing of 3D Shapes"), with the
// settings of its published code, on this project's prior and renderer. See docs/compare.md for the
// differences.
#pragma once

#include "item3d/baselines/trimap.h"
#include "item3d/baselines/view_painter.h"

namespace item3d {

class TexturePainter : public ViewPainter {
  public:
    TexturePainter(const PaintingScene& scene, const PainterOptions& options);
    static std::int64_t step_count(const PainterOptions& options);
    void step(std::int64_t index) override;
    void finish() override;

  private:
    TrimapInput look(const ViewRender& render) const;
};

/// Returns the mask [1, 1, h, w], of 0 and 1, that a step draws. In the first half of the steps,
/// the refined parts are drawn only in every second cell of a checkerboard, so that the result
/// resembles the previous content. A cell has 2 x 2 latents (64 x 64 latents have 32 x 32 cells).
/// In the second half, all of `update` is drawn.
at::Tensor drawn_cells(const Trimap& map, std::int64_t height, std::int64_t width, int step,
                       int steps);

}  // namespace item3d
