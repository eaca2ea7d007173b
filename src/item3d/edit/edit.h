// The main path of an edit: load model -> fit field -> loop { cameras -> render -> guidance ->
// backward -> step } -> bake -> write.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Runs an edit and writes every file that docs/formats.md lists into the output folder. Returns
/// the content of edit.json on the request's first process, and null on the others. Throws
/// InputError, ResourceError, and Interrupted (with the checkpoint written) as core/error.h says.
nlohmann::json edit_model(const EditRequest& request);
/// Runs one of several edits that share `session`. Takes the previous edit's model from the
/// session, and stores the edited model in it for the next edit.
nlohmann::json edit_model(const EditRequest& request, EditSession& session);

}  // namespace item3d
