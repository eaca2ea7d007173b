// The detail stage, which paints what guidance leaves out.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Paints fine detail. Guidance's gradient is an average over noises, and an average has no grain:
/// a small prior's edit ends in the right colour, shine and metal, as smooth as before. So the
/// prior then samples, view after view (painting_plan.h): a picture of the model is noised,
/// denoised with the target sentence where no earlier view has painted, and the field's base colour
/// is fitted to it (TEXTure, Richardson et al. 2023, in a neural texture). Close-ups then refine
/// all of it by SDEdit's sampling (Meng et al. 2022). All other channels stay as guidance left
/// them. Does nothing when all views of the plan are painted. Throws as optimize().
void add_detail(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
