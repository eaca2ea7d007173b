// The light alone, found by guidance: geometry and materials stay as they are.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/session.h"
#include "item3d/scene/image.h"

#include <nlohmann/json.hpp>

namespace item3d {

struct FoundLight {
    Image first;  ///< what the optimisation began with, 256 x 512 x 3, equirectangular
    Image light;  ///< what it ended with
    /// "settings", "seconds", the EditClaim "claim" unless the plan is silent, and, for a physical
    /// light, its "values".
    nlohmann::json record;
};

/// Optimises the light that the request's plan begins with towards their target sentence. Keeps
/// checkpoints and a preview in the request's output folder, which must be there, and takes them up
/// where the request says resume. Networks are the session's. Throws as edit_model.
FoundLight find_light(const EditRequest& request, EditSession& session);

}  // namespace item3d
