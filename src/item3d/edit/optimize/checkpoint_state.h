// The saving and loading of an edit's state as a checkpoint.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"

namespace item3d {

/// Writes the checkpoint of the request. Only the first process writes it.
void save_state(const EditRequest& request, const EditState& state);

/// Fills `state` from the checkpoint. The state's field, optimiser and guidance must be built
/// already. Returns false if there is no checkpoint. If there are several processes, all of them
/// get the data that the first one reads. Throws InputError if the checkpoint belongs to another
/// model or other settings.
bool load_state(const EditRequest& request, EditState& state);

/// Throws InputError on all processes if the input or the settings of any process differ from the
/// first's.
void require_one_request(const EditRequest& request, const EditState& state);

}  // namespace item3d
