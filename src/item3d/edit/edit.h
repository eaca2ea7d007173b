// item3d's main path: load model -> fit field -> loop { cameras -> render -> guidance -> backward
// -> step } -> bake -> write.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Runs an edit and writes everything that docs/formats.md lists into the output folder. Returns
/// the content of edit.json; null on processes other than the request's first. Throws InputError,
/// ResourceError, and Interrupted (with the checkpoint written) as core/error.h says.
nlohmann::json edit_model(const EditRequest& request);
/// One of the edits that share a session: what it left is taken, and the edited model is left for
/// the next.
nlohmann::json edit_model(const EditRequest& request, EditSession& session);

}  // namespace item3d
