// What an edit says of itself in what it writes.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"
#include "item3d/provenance/provenance.h"

namespace item3d {

/// Sentences, method, prior, input and date of an edit. Reads the input for its hash.
EditClaim claim_of(const EditRequest& request, const EditState& state);

/// The same with the request's key; nothing where the plan is silent.
Provenance provenance_of(const EditRequest& request, const EditState& state);

}  // namespace item3d
