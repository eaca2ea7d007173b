// The detail stage, which paints the fine texture that guidance leaves out.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Paints fine detail. Guidance averages its gradient over many noises, which removes grain. With a
/// small prior, an edit therefore ends with the right colour, roughness and metallic, but as smooth
/// as before. In this stage the prior paints one view after another (painting_plan.h). A render of
/// the model is noised, and then denoised with the target sentence where no earlier view has
/// painted. The neural texture's base colour is then fitted to the result. This is the method
/// TEXTure (Richardson et al. 2023), applied to a neural texture. Afterwards, close-ups refine the
/// whole surface by the sampling of SDEdit (Meng et al. 2022). All channels but base colour keep
/// the values that guidance gave them. Does nothing if all views of the plan are painted already.
/// Throws as optimize().
void add_detail(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
