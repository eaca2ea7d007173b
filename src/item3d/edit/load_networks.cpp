#include "item3d/edit/load_networks.h"

#include "item3d/baselines/masked_sampling.h"
#include "item3d/baselines/view_painter.h"
#include "item3d/core/available_memory.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/verify.h"
#include "item3d/region/region_readers.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

constexpr double gigabyte = 1e9;

struct Need {
    double weights = 0, high = 0, low = 0;  ///< bytes
};

Need estimate(const EditRequest& request, at::ScalarType precision) {
    const PriorReport report = verify_prior(request.prior);
    if (!report.usable()) return {};  // loading reports the reason
    const double side = static_cast<double>(request.plan.resolution) / report.resolution;
    const double images = request.plan.batch * side * side;
    for (const MemoryReport& memory : report.memory) {
        if (memory.precision != precision_name(precision)) continue;
        const auto all = static_cast<double>(memory.weights);
        const auto text = static_cast<double>(memory.text_encoders);
        // If sentences are added during the edit, or there are LoRA files, all networks must be in
        // memory at once.
        const bool at_once = request.plan.asks_captioner || !request.plan.lora.empty();
        const double weights = at_once ? all : std::max(all - text, text);
        const double base = weights + static_cast<double>(memory.program);
        return {weights, base + images * static_cast<double>(memory.kept_by_gradients),
                base + images * static_cast<double>(memory.kept_when_low)};
    }
    ITEM3D_CHECK(false, "a precision without an estimate");
}

}  // namespace

std::filesystem::path networks_folder(const EditRequest& request) {
    return request.plan.method == "in2n" && !request.instruct.empty() ? request.instruct
                                                                      : request.prior;
}

void add_needs(PriorNeeds& needs, const EditRequest& request, const EditPlan& plan,
               const PriorVocabulary& vocabulary) {
    const auto ask = [&](const std::vector<std::string>& sentences) {
        needs.sentences.insert(needs.sentences.end(), sentences.begin(), sentences.end());
    };
    const std::string to = vocabulary.reading(plan.to);
    ask({vocabulary.reading(plan.from), to, plan.negative_prompt});
    if (request.segmenter.empty()) ask(prompts_of_words({plan.region, plan.exclude}));
    if (plan.method == "in2n") ask({plan.dataset_update_options().instruction});
    if (plan.paints_views) ask(painting_prompts(to, plan.negative_prompt));
    needs.decoder =
        needs.decoder || plan.paints_detail || plan.paints_views || plan.method == "in2n";
}

std::shared_ptr<DiffusionModel> load_networks(const EditRequest& request, const PriorNeeds& needs) {
    const EditPlan& plan = request.plan;
    if (needs.any_sentence) {
        auto prior = std::make_shared<Pipeline>(
            Pipeline::load(networks_folder(request), needs.device, needs.precision));
        prior->add(plan);
        return prior;
    }
    RunNeeds run{needs.sentences, needs.decoder};
    run.prompts.push_back(default_negative_prompt());
    return std::make_shared<RunningPipeline>(
        RunningPipeline::load(networks_folder(request), needs.device, needs.precision, plan, run));
}

std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       at::ScalarType precision) {
    if (!request.plan.asks_captioner) return nullptr;
    if (request.captioner.empty())
        throw InputError(
            "--adjust " + adjustment_names().at(static_cast<std::size_t>(request.plan.adjust)),
            "needs a captioner, and the prior has none",
            "give a folder with BLIP or BLIP-2 with --captioner");
    return load_captioner(request.captioner, request.device, precision);
}

void make_prior_ready(DiffusionModel& prior, const EditPlan& plan, bool low_memory) {
    for (const auto& [option, text] : {std::pair("--from", plan.from), std::pair("--to", plan.to)})
        warn_of_lost_words(prior.tokenizer(), option, text);
    prior.recompute_in_backward(low_memory);
}

std::shared_ptr<const DiffusionModel> load_inpainter(const EditRequest& request, at::Device device,
                                                     at::ScalarType precision,
                                                     const std::string& to) {
    if (request.inpainting.empty()) return nullptr;
    RunNeeds needs;
    needs.prompts = painting_prompts(to, request.plan.negative_prompt);
    needs.decoder = false;
    auto model = std::make_shared<RunningPipeline>(
        RunningPipeline::load(request.inpainting, device, precision, {}, needs));
    if (!is_inpainter(*model))
        throw InputError(request.inpainting.string(),
                         fmt::format("is not an inpainting model: its U-Net has {} input channels, "
                                     "expected {} (latents, mask, latents)",
                                     model->latent_channels() + model->condition_channels(),
                                     2 * model->latent_channels() + 1),
                         "give a Stable Diffusion inpainting model, or leave --inpainting out");
    return model;
}

bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device,
                      bool is_loaded) {
    if (request.memory != "auto" && request.memory != "low" && request.memory != "high")
        throw InputError("--memory", "'" + request.memory + "' is not known",
                         "choose auto, low or high");
    // Memory of other devices is not checked: LibTorch's error names the shortage.
    if (!device.is_cpu()) return request.memory == "low";
    const Need need = estimate(request, precision);
    const double free = available_memory() + (is_loaded ? need.weights : 0);
    if (need.weights > free)
        throw ResourceError(fmt::format(
            "{}: its weights need {:.1f} GB in {}, but {:.1f} GB of memory are free; close other "
            "programs{}",
            request.prior.string(), need.weights / gigabyte, precision_name(precision),
            free / gigabyte, precision == at::kFloat ? ", or try --precision bf16" : ""));
    const bool low = request.memory == "low" || (request.memory == "auto" && need.high > free);
    const double wanted = low ? need.low : need.high;
    if (wanted > free)
        warn(
            fmt::format("this edit may need {:.1f} GB, but {:.1f} GB of memory are free; use {}a "
                        "smaller --resolution or --batch",
                        wanted / gigabyte, free / gigabyte, low ? "" : "--memory low or "));
    else if (low && request.memory == "auto")
        note(
            fmt::format("the edit needs about {:.1f} GB, but {:.1f} GB are free: it continues with "
                        "--memory low, which takes longer",
                        need.high / gigabyte, free / gigabyte));
    return low;
}

}  // namespace item3d
