// item3d's main path: load model -> fit field -> loop { cameras -> render -> guidance -> backward
// -> step } -> bake -> write.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Runs an edit and writes everything that docs/formats.md lists into the output folder. Returns
/// the content of edit.json. Throws InputError, ResourceError, and Interrupted (with the checkpoint
/// written) as core/error.h says.
nlohmann::json edit_model(const EditRequest& request);

}  // namespace item3d
