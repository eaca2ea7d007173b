// The layer file of an edit. It stores the edit's change, which can be applied again at any
// strength.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/field/bake/bake.h"

#include <map>

namespace item3d {

/// Writes layer.safetensors (docs/formats.md) into the edit's folder. unedited: as filled by
/// bake().
void write_layer_file(const EditRequest& request, const EditScene& scene, const EditState& state,
                      const ModelEdit& edit, const std::map<int, UneditedImages>& unedited);

}  // namespace item3d
