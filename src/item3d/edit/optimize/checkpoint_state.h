// An edit's state to and from its checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Writes the checkpoint of the request, where this is its first process.
void save_state(const EditRequest& request, const EditState& state);

/// Fills `state` (whose field, optimiser and guidance are already built) from the checkpoint; false
/// when there is none. With several processes all get what the first one reads. Throws InputError
/// when it belongs to another model or other settings.
bool load_state(const EditRequest& request, EditState& state);

/// Throws InputError, on all processes, where one of several has another input or other settings
/// than the first.
void require_one_request(const EditRequest& request, const EditState& state);

}  // namespace item3d
