#include "item3d/edit/relight.h"

#include "item3d/core/error.h"
#include "item3d/core/stage_times.h"
#include "item3d/edit/optimize/initial_state.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/edit_claim.h"
#include "item3d/edit/scene.h"
#include "item3d/lighting/optimized/physical_light.h"

namespace item3d {
namespace {

constexpr int found_light_height = 256;

nlohmann::json values_json(const PhysicalValues& values) {
    return {{"exposure", values.exposure},
            {"sun_share", values.sun_share},
            {"sun_warmth_mired", values.sun_warmth},
            {"sky_warmth_mired", values.sky_warmth},
            {"ground", values.ground},
            {"glow", values.glow},
            {"sun", {{"azimuth", values.sun.azimuth}, {"elevation", values.sun.elevation}}}};
}

}  // namespace

FoundLight find_light(const EditRequest& request, EditSession& session) {
    ITEM3D_CHECK(!request.plan.edits_texture, "find_light changes no texture");
    StageTimes times;
    const EditScene scene = load_scene(request, session);
    EditState state = begin_or_resume(request, scene);
    FoundLight found;
    found.first = state.light->image(found_light_height);
    times.end_stage("load");
    optimize(request, scene, state);
    times.end_stage("optimize");
    found.light = state.light->image(found_light_height);

    nlohmann::json seconds = nlohmann::json::object();
    for (const auto& [stage, value] : times.stages())
        seconds[stage] = value;
    found.record = {{"settings", request.plan}, {"seconds", seconds}};
    if (request.plan.provenance == SaysProvenance::on)
        found.record["claim"] = claim_of(request, state);
    if (const auto* physical = dynamic_cast<const PhysicalLight*>(state.light.get()))
        found.record["values"] = values_json(physical->values());
    return found;
}

}  // namespace item3d
