#include "item3d/edit/outputs/edit_claim.h"

#include "item3d/core/digest.h"
#include "item3d/core/files.h"
#include "item3d/core/version.h"

namespace item3d {

EditClaim claim_of(const EditRequest& request, const EditState& state) {
    const EditPlan& plan = request.plan;
    EditClaim claim;
    claim.from = plan.from;
    claim.to = plan.to;
    claim.method = plan.method == "item3d" ? "item3d, " + plan.guidance : plan.method;
    claim.prior = request.prior.filename().string();
    claim.prior_hash = state.prior_weights;
    claim.input = request.model.filename().string();
    claim.input_sha256 = sha256(read_bytes(request.model));
    claim.date = state.begun;
    claim.version = version();
    return claim;
}

Provenance provenance_of(const EditRequest& request, const EditState& state) {
    if (request.plan.provenance == SaysProvenance::off) return {};
    return {{claim_of(request, state)}, request.sign_key};
}

}  // namespace item3d
