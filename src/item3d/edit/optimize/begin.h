// The beginning of an edit: a field fitted to the model's own materials, or a checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Fits a field to the input's materials, or takes everything from the checkpoint in the output
/// folder when the request says resume and one is there.
EditState begin_or_resume(const EditRequest& request, const EditScene& scene);

}  // namespace item3d
