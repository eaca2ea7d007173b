// TEXTure (Richardson et al. 2023, "TEXTure: Text-Guided Texturing of 3D Shapes"), with the
// settings of its published code, on this project's prior and renderer. See docs/compare.md for
// what differs.
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

/// [1, 1, h, w] of 0 and 1: what is drawn anew in a step. In the first half of the steps the places
/// that are refined take part in every other cell of 2 x 2 latents of a checkerboard (of 32 x 32
/// cells on 64 x 64 latents), so that what is drawn looks like what was there; then all of
/// `update`.
at::Tensor drawn_cells(const Trimap& map, std::int64_t height, std::int64_t width, int step,
                       int steps);

}  // namespace item3d
