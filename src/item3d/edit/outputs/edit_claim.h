// The provenance claim of an edit.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"
#include "item3d/provenance/provenance.h"

namespace item3d {

/// Returns sentences, method, prior, input and date of an edit. Reads the input for its hash.
EditClaim claim_of(const EditRequest& request, const EditState& state);

/// Returns the claim with the request's key; empty where the plan disables provenance.
Provenance provenance_of(const EditRequest& request, const EditState& state);

}  // namespace item3d
