// How well does one edit of the study do, and how long does it take?
#include "bench/ablation_edit.h"

#include "item3d/core/files.h"
#include "item3d/core/stage_times.h"
#include "item3d/edit/material_source.h"
#include "item3d/edit/optimize/begin.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/metrics/clip_score.h"
#include "item3d/render/pictures.h"
#include "item3d/report/model_pictures.h"
#include "item3d/suite/look_by_clip.h"

#include <cmath>

namespace item3d {
namespace {

using nlohmann::json;

constexpr int view_count = 6;
constexpr int view_pixels = 256;

EditRequest request_of(const Contender& contender, const SuiteCase& test, std::uint64_t seed,
                       const AblationOptions& options, const std::filesystem::path& folder) {
    EditRequest request;
    request.model = folder / "source.glb";
    request.prior = options.prior;
    request.output = folder;
    json overrides = contender.overrides;
    overrides.update({{"from", prompt_of(test.source, test.mesh)},
                      {"to", prompt_of(test.target, test.mesh)},
                      {"seed", seed},
                      {"iterations", std::lround(options.rows / contender.rows)},
                      // All take the steps that they are given, and draw no detail of the prior's
                      // own afterwards: guidance alone is compared.
                      {"settle", 0},
                      {"detail", "off"},
                      {"texture_size", test.group == "stripes" ? 512 : 256}});
    request.plan = resolve_plan(options.prior, overrides);
    if (request.plan.asks_captioner) request.captioner = find_in_prior(options.prior, "captioner");
    return request;
}

/// "right" and how that was found; nothing for stripes.
json success(const SuiteCase& test, const SurfaceMeans& means, const at::Tensor& pictures,
             const AblationJudge& judge) {
    if (test.group == "stripes") return json::object();
    std::string found;
    if (test.group == "colors") {
        const auto colors = named_colors(judge.vocabulary);
        found = colors[nearest_color(means.base_color, colors)].name;
    } else {
        found = look_by_clip(pictures, test.mesh, judge.clip, judge.vocabulary,
                             {"colors", "materials"});
    }
    return {{"found", found}, {"right", found == test.word}};
}

void save_first(const std::filesystem::path& path, const at::Tensor& pictures) {
    save_image(path, to_image(pictures[0].permute({1, 2, 0})));
}

}  // namespace

json run_ablation_edit(const Contender& contender, const SuiteCase& test, std::uint64_t seed,
                       const AblationOptions& options, const AblationJudge& judge,
                       const std::filesystem::path& folder) {
    StageTimes times;
    const EditRequest request = request_of(contender, test, seed, options, folder);
    save_model(request.model,
               source_model(test, load_model(options.meshes.at(test.mesh)), judge.vocabulary));
    const EditScene scene = load_scene(request);
    EditState state = begin_or_resume(request, scene);
    times.end_stage("load and fit");
    const IterationTimes iterations = optimize(request, scene, state);
    times.end_stage("optimize");
    const Model edited = bake_and_save(request, scene, state).model;
    times.end_stage("bake");

    const at::NoGradGuard no_grad;
    const EnvironmentLight light = prefilter(load_light(request.plan.light), 64);
    const auto cameras = picture_cameras(scene.model, view_count);
    const at::Tensor was = draw_pictures(scene.model, light, cameras, view_pixels);
    const at::Tensor is = draw_pictures(edited, light, cameras, view_pixels);
    const ClipScores scores = clip_scores(judge.clip, over_white(was), over_white(is),
                                          request.plan.from, request.plan.to);
    const SurfaceMeans means = surface_means(edited, scene.materials);
    save_first(folder / "before.png", over_white(was));
    save_first(folder / "after.png", over_white(is));

    json result = success(test, means, over_white(is), judge);
    result.update(
        {{"contender", contender.name},
         {"group", test.group},
         {"mesh", test.mesh},
         {"from", request.plan.from},
         {"to", request.plan.to},
         {"seed", seed},
         {"rows", options.rows},
         {"iterations", request.plan.iterations},
         {"directional", scores.mean.directional},
         {"global", scores.mean.global},
         {"global_before", scores.mean.global_before},
         {"kept", detail_kept(was, is)},
         {"base_color_linear", {means.base_color.x, means.base_color.y, means.base_color.z}},
         {"metallic", means.metallic},
         {"roughness", means.roughness},
         {"seconds_optimize", times.stages()[1].second},
         {"seconds_adjust", iterations.adjust},
         {"seconds", times.total()}});
    if (request.plan.asks_captioner) {
        result["captions"] = json::array();
        for (const AdjustmentRecord& record : state.adjustment.records)
            result["captions"].push_back(record);
        result["caption_failure"] = state.adjustment.failure;
    }
    return result;
}

}  // namespace item3d
