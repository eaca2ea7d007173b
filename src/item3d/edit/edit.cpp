#include "item3d/edit/edit.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress_file.h"
#include "item3d/core/stage_times.h"
#include "item3d/edit/detail/detail_stage.h"
#include "item3d/edit/optimize/initial_state.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/baked_by_first.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/edit/outputs/edit_images.h"
#include "item3d/edit/outputs/summary.h"
#include "item3d/edit/painting/painting.h"
#include "item3d/edit/scene.h"
#include "item3d/io/overwrite.h"

#include <optional>

namespace item3d {
namespace {

/// Throws InputError if there are several processes but the method cannot use them, because it
/// makes one image after another.
void check_processes(const EditRequest& request) {
    const std::string& method = request.plan.method;
    if (request.processes.several() && (request.plan.paints_views || method == "in2n"))
        throw InputError("--method " + method, "cannot be distributed over several processes",
                         "start one process, without RANK and WORLD_SIZE");
}

}  // namespace

nlohmann::json edit_model(const EditRequest& request) {
    EditSession session;
    return edit_model(request, session);
}

nlohmann::json edit_model(const EditRequest& request, EditSession& session) {
    StageTimes times;
    check_processes(request);
    check_not_replaced(request.model, request.output / model_file_name(request.model));
    check_textures_not_replaced(request.model, request.texture_folders,
                                request.output / "textures");
    const ProcessGroup& processes = request.processes;
    std::optional<OutputFolder> folder;
    if (processes.first()) folder.emplace(request.output);

    show_stage("load");
    EditScene scene = load_scene(request, session);
    // CLIP is used for the scores at the end, but a bad folder should fail at once.
    std::shared_ptr<const Clip> clip;
    if (processes.first()) clip = session.clip(request.clip);
    times.end_stage("load");

    std::future<Atlas> atlas = unwrap_meanwhile(request, scene);
    EditState state;
    IterationTimes iteration_times;
    if (request.plan.paints_views) {
        scene.atlas = atlas.get();
        state = begin_painting(request, scene);
        times.end_stage("begin");
        paint_views(request, scene, state);
        times.end_stage("paint");
    } else {
        state = begin_or_resume(request, scene);
        scene.atlas = atlas.get();
        times.end_stage("fit");
        iteration_times = optimize(request, scene, state);
        times.end_stage("optimize");
    }

    if (request.plan.paints_detail) {
        add_detail(request, scene, state);
        times.end_stage("detail");
    }

    show_stage("bake");
    EditedModel edited = bake_by_first(request, scene, state);
    scene.release_textures();
    times.end_stage("bake");

    show_stage("report");
    const EditImages images = render_images(request, scene, edited, clip.get(), session);
    times.end_stage("report");
    if (!processes.first()) {
        processes.wait_for_first();
        return nullptr;
    }

    nlohmann::json summary =
        write_summary(request, scene, state, times, iteration_times, edited, images);
    if (edited.is_as_read)
        session.keep_model(request.output / model_file_name(request.model), request.plan.variant,
                           std::move(edited.model));
    processes.wait_for_first();
    return summary;
}

}  // namespace item3d
