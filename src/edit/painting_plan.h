// From where the detail stage paints a model, and what each view paints anew.
#pragma once

#include "item3d/edit/scene.h"

#include <torch/types.h>

#include <vector>

namespace item3d {

struct PaintingView {
    Camera camera;
    bool is_close_up = false;
    int first_of_kind = 0;  ///< where its kind begins in the plan
    /// [1, 1, h, w] on the grid of the prior's latents. 1: what earlier views of its kind painted
    /// (or the background) stays as it is; 0: painted anew.
    torch::Tensor known;
    torch::Tensor facing;  ///< [1, 1, R, R] 0 or 1: not seen at too flat an angle
};

/// First views of the whole model, around it by the golden angle, so that each shows something new
/// however many there are: a point belongs to the first view that sees it from well in front
/// (TEXTure, Richardson et al. 2023). Then close-ups, two fifths of all, in the same manner. A
/// function of the scene and the settings alone.
std::vector<PaintingView> plan_painting(const EditScene& scene, const EditSettings& settings);

}  // namespace item3d
