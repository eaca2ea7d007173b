// The detail stage: paints the fine texture that guidance leaves out.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Paints fine detail. Guidance averages its gradient over many noises, which removes grain: a
/// small prior's edit ends with the right colour, roughness and metallic, but as smooth as before.
/// The prior therefore samples one view after another (painting_plan.h): an image of the model is
/// noised and denoised with the target sentence where no earlier view has painted, and the field's
/// base colour is fitted to the result (TEXTure, Richardson et al. 2023, in a neural texture).
/// Close-ups then refine the whole surface by SDEdit's sampling (Meng et al. 2022). All other
/// channels keep guidance's values. Does nothing once every view of the plan is painted. Throws as
/// optimize().
void add_detail(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
