// The initial state of an edit: a field fitted to the model's own materials, or a checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Returns a state whose field is fitted to the input's materials, or the checkpoint in the output
/// folder when the request resumes and one exists.
EditState begin_or_resume(const EditRequest& request, const EditScene& scene);

}  // namespace item3d
