// Relighting, which optimises the light by guidance. Geometry and materials stay as they are.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"
#include "item3d/scene/image.h"

#include <nlohmann/json.hpp>

namespace item3d {

struct FoundLight {
    Image first;  ///< the initial light, 256 x 512 x 3, equirectangular
    Image light;  ///< the optimised light
    /// Has the keys "settings" and "seconds"; "claim", the EditClaim, unless the plan disables
    /// provenance; and "values", if the light is physical.
    nlohmann::json record;
};

/// Optimises the plan's initial light towards the target sentence. Writes checkpoints and a preview
/// to the request's output folder, which must exist. Resumes from a checkpoint there if the request
/// says so. The networks come from the session. Throws as edit_model().
FoundLight find_light(const EditRequest& request, EditSession& session);

}  // namespace item3d
