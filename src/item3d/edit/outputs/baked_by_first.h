// A bake by the first of several processes.
#pragma once

#include "item3d/edit/outputs/baked_files.h"

namespace item3d {

/// Calls bake_and_save() on the request's first process and sends the model to the other processes,
/// without the thumbnails of its textures. Throws as bake_and_save(), and InputError if a temporary
/// file cannot be written.
EditedModel bake_by_first(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
