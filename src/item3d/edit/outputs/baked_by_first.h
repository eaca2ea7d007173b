// The edited model on all processes, of which the first one bakes it.
#pragma once

#include "item3d/edit/outputs/baked_files.h"

namespace item3d {

/// bake_and_save() on the request's first process; the others get the model from it, without its
/// textures' thumbnails. Throws as that does, and InputError where a temporary file cannot be
/// written.
EditedModel bake_by_first(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
