// The views of the detail stage: cameras, and the pixels that each view paints.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Purpose of a view, in the order of the plan.
enum class PaintingRound {
    initial,   ///< the whole model, painted from noise
    refine,    ///< the whole model again, from the previous round's result
    close_up,  ///< a part of the model, from the previous round's result
};

struct PaintingView {
    Camera camera;
    PaintingRound round = PaintingRound::initial;
    int first_of_round = 0;  ///< index of its round's first view in the plan
    /// [1, 1, h, w] on the grid of the prior's latents. A latent that this view paints has 0. A
    /// latent that is kept has 1, because an earlier view of the round painted it or it is
    /// background.
    at::Tensor known;
    at::Tensor facing;  ///< [1, 1, R, R] 0 at grazing angles and on background, else 1
};

/// Returns the views of the detail stage. Two fifths are in the round `initial`, three tenths in
/// `refine`, and the rest in `close_up`. From view to view the camera turns around the model by the
/// golden angle, so that any number of views covers the model. In each round a point belongs to the
/// first view that sees it nearly head-on (TEXTure, Richardson et al. 2023). Deterministic in the
/// scene and the plan.
std::vector<PaintingView> plan_painting(const EditScene& scene, const EditPlan& plan);

}  // namespace item3d
