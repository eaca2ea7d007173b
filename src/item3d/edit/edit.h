// The main path of an edit: load model -> fit field -> loop { cameras -> render -> guidance ->
// backward -> step } -> bake -> write.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Runs an edit and writes every file that docs/formats.md lists into the output folder. Returns
/// the content of edit.json; null on processes other than the request's first. Throws InputError,
/// ResourceError, and Interrupted (with the checkpoint written) as core/error.h says.
nlohmann::json edit_model(const EditRequest& request);
/// Runs one of the edits that share a session: takes the model that the previous edit left there,
/// and leaves the edited model for the next.
nlohmann::json edit_model(const EditRequest& request, EditSession& session);

}  // namespace item3d
