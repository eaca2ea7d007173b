// Saving and loading of an edit's state as a checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Writes the checkpoint of the request, on its first process only.
void save_state(const EditRequest& request, const EditState& state);

/// Fills `state` (whose field, optimiser and guidance are already built) from the checkpoint.
/// Returns false when there is none. With several processes, all get the data that the first one
/// reads. Throws InputError when the checkpoint belongs to another model or other settings.
bool load_state(const EditRequest& request, EditState& state);

/// Throws InputError, on all processes, where the input or settings of any process differ from the
/// first's.
void require_one_request(const EditRequest& request, const EditState& state);

}  // namespace item3d
