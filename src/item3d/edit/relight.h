// Relighting: optimises the light by guidance; geometry and materials stay as they are.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"
#include "item3d/scene/image.h"

#include <nlohmann/json.hpp>

namespace item3d {

struct FoundLight {
    Image first;  ///< the initial light, 256 x 512 x 3, equirectangular
    Image light;  ///< the optimised light
    /// "settings", "seconds", the EditClaim "claim" unless the plan disables provenance, and, for a
    /// physical light, its "values".
    nlohmann::json record;
};

/// Optimises the plan's initial light towards the target sentence. Writes checkpoints and a preview
/// to the request's output folder, which must exist, and resumes from them where the request says
/// so. The networks come from the session. Throws as edit_model().
FoundLight find_light(const EditRequest& request, EditSession& session);

}  // namespace item3d
