// The provenance claim of an edit.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/state.h"
#include "item3d/provenance/provenance.h"

namespace item3d {

/// Returns the claim, with the sentences, method, prior, input and date of an edit. Reads the input
/// to hash it.
EditClaim claim_of(const EditRequest& request, const EditState& state);

/// Returns the claim and the request's key; empty if the plan disables provenance.
Provenance provenance_of(const EditRequest& request, const EditState& state);

}  // namespace item3d
