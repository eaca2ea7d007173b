// The detail stage: paints the fine texture that guidance leaves out.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Paints fine detail. Guidance averages its gradient over many noises, which removes grain: a
/// small prior's edit ends with the right colour, roughness and metallic, but as smooth as before.
/// The prior therefore paints one view after another (painting_plan.h). It noises a render of the
/// model, and denoises it with the target sentence where no earlier view has painted. The field's
/// base colour is then fitted to the result. This is the method TEXTure (Richardson et al. 2023),
/// applied to a neural texture. Afterwards, close-ups refine the whole surface by SDEdit's sampling
/// (Meng et al. 2022). All channels but base colour keep the values that guidance gave them. Does
/// nothing once every view of the plan is painted. Throws as optimize().
void add_detail(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
