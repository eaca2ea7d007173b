// The initial state of an edit. It is a neural texture fitted to the model's own materials, or a
// checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Returns the state in the checkpoint, if the request resumes and there is one. Otherwise returns
/// a state whose neural texture is fitted to the model's materials.
EditState begin_or_resume(const EditRequest& request, const EditScene& scene);

}  // namespace item3d
