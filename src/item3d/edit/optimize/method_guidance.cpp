#include "item3d/edit/optimize/method_guidance.h"

#include "item3d/baselines/clip_guidance.h"
#include "item3d/baselines/dataset_update.h"
#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <filesystem>

namespace item3d {
namespace {

std::unique_ptr<Guidance> clip_guidance(const EditRequest& request, const EditScene& scene) {
    const auto& folder = request.teacher.empty() ? request.clip : request.teacher;
    if (folder.empty())
        throw InputError("--method clip", "needs a CLIP model, and the prior has none",
                         "give a folder in the transformers layout with --teacher");
    if (!request.teacher.empty() && !std::filesystem::is_directory(request.teacher))
        throw InputError("--teacher " + request.teacher.string(), "no such folder",
                         "give a CLIP model in the transformers layout, or leave --teacher out");
    if (folder == request.clip)
        note(
            "clip: the guiding CLIP model also scores the result, which favours this method "
            "(--teacher sets another)");
    return std::make_unique<ClipGuidance>(
        std::make_shared<const Clip>(Clip::load(folder, scene.device)), request.plan.from,
        request.plan.to, request.plan.clip_loss);
}

}  // namespace

std::unique_ptr<Guidance> guidance_of_method(const EditRequest& request, const EditScene& scene) {
    const EditPlan& plan = request.plan;
    if (plan.method == "clip") return clip_guidance(request, scene);
    if (plan.method == "in2n") {
        DatasetUpdateOptions options = plan.dataset_update_options();
        options.subject = (request.instruct.empty() ? request.prior : request.instruct).string();
        return std::make_unique<DatasetUpdate>(scene.prior(), options);
    }
    return make_guidance(scene.prior(), scene.from, scene.to, plan.guidance_options());
}

std::vector<Camera> cameras_of_method(const EditScene& scene, const EditPlan& plan,
                                      std::int64_t iteration) {
    if (plan.method != "in2n")
        return sample_cameras(scene.sphere, plan.batch, plan.seed, iteration);
    const int count = plan.dataset_update_options().views;
    const std::vector<Camera> all = sample_cameras(scene.sphere, count, plan.seed, 0);
    std::vector<Camera> cameras;
    for (const std::int64_t view : dataset_views(plan.seed, iteration, plan.batch, count))
        cameras.push_back(all[static_cast<std::size_t>(view)]);
    return cameras;
}

}  // namespace item3d
