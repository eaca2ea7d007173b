// ControlNet in two dimensions (Zhang et al. 2023): draws each view separately from its depth and
// the target sentence, without consistency between views. The images themselves are the result. The
// texture shows how they disagree: each texel has the colour of the view that sees it at the
// largest cosine of the viewing angle.
#pragma once

#include "item3d/baselines/view_painter.h"

namespace item3d {

class Controlnet2d : public ViewPainter {
  public:
    Controlnet2d(const PaintingScene& scene, const PainterOptions& options);
    static std::int64_t step_count(const PainterOptions& options);
    void step(std::int64_t index) override;
    void finish() override;
};

}  // namespace item3d
