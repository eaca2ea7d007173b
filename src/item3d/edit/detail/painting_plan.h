// From where the detail stage paints a model, and what each view paints anew.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// The purpose of a view. The plan has them in this order.
enum class PaintingRound {
    initial,   ///< the whole model, painted anew
    refine,    ///< the whole model once more, from what the round before left
    close_up,  ///< a part of it, likewise
};

struct PaintingView {
    Camera camera;
    PaintingRound round = PaintingRound::initial;
    int first_of_round = 0;  ///< where its round begins in the plan
    /// [1, 1, h, w] on the grid of the prior's latents. 1: what earlier views of its round painted
    /// (or the background) stays as it is; 0: painted anew.
    at::Tensor known;
    at::Tensor facing;  ///< [1, 1, R, R] 0 or 1: not seen at too flat an angle
};

/// Two fifths of the views are initial, three tenths refine, the others are close-ups. The views go
/// around the model by the golden angle, so that each shows something new however many there are:
/// in each round a point belongs to the first view that sees it from well in front (TEXTure,
/// Richardson et al. 2023). A function of the scene and the plan alone.
std::vector<PaintingView> plan_painting(const EditScene& scene, const EditPlan& plan);

}  // namespace item3d
