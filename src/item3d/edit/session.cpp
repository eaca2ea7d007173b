#include "item3d/edit/session.h"

#include "item3d/io/load.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/checkpoint.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

/// Returns the key that determines which networks are loaded.
nlohmann::json key_of(const EditRequest& request, const PriorUse& use) {
    const PipelineExtras& extras = request.plan;
    return {{"prior", networks_folder(request).string()},
            {"device", use.device.str()},
            {"precision", precision_name(use.precision)},
            {"any_sentence", request.plan.asks_captioner},
            {"extras", extras}};
}

/// Returns what all known edits require of the request's prior.
PriorNeeds needs_of(const EditRequest& request, const std::vector<EditPlan>& plans,
                    const PriorUse& use) {
    PriorNeeds needs{use.device, use.precision, request.plan.asks_captioner, {}, false};
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    add_needs(needs, request, request.plan, vocabulary);
    for (const EditPlan& plan : plans)
        add_needs(needs, request, plan, vocabulary);
    return needs;
}

/// True if a loaded prior can encode these sentences or has encoded them already.
bool can_serve(const std::shared_future<std::shared_ptr<DiffusionModel>>& prior,
               const PriorNeeds& needs) {
    try {
        const auto* running = dynamic_cast<const RunningPipeline*>(prior.get().get());
        return !running || running->can_learn_prompts() || running->knows_prompts(needs.sentences);
    } catch (const std::exception&) {
        return false;  // the prior failed to load, which the previous edit reported
    }
}

}  // namespace

EditSession::EditSession(const std::vector<EditRequest>& edits) {
    for (const EditRequest& edit : edits)
        plans_.push_back(edit.plan);
}

Model EditSession::take_model(const EditRequest& request) {
    std::optional<KeptModel> kept = std::exchange(model_, std::nullopt);
    const bool is_kept =
        kept && kept->path == request.model && kept->variant == request.plan.variant;
    Model model = is_kept ? std::move(kept->model)
                          : load_model(request.model, {.texture_folders = request.texture_folders,
                                                       .variant = request.plan.variant});
    add_groups(model);
    return model;
}

void EditSession::keep_groups(const Model& model) {
    groups_ = model.groups;
    triangle_groups_.clear();
    for (const Primitive& primitive : model.primitives)
        triangle_groups_.push_back(primitive.triangle_groups);
}

void EditSession::add_groups(Model& model) const {
    if (groups_.empty() || !model.groups.empty()) return;
    const bool fits =
        std::equal(model.primitives.begin(), model.primitives.end(), triangle_groups_.begin(),
                   triangle_groups_.end(), [](const Primitive& primitive, const auto& groups) {
                       return groups.empty() || groups.size() == primitive.indices.size() / 3;
                   });
    if (!fits) return;
    model.groups = groups_;
    for (std::size_t i = 0; i < model.primitives.size(); ++i)
        model.primitives[i].triangle_groups = triangle_groups_[i];
}

void EditSession::keep_model(const std::filesystem::path& path, const std::string& variant,
                             Model model) {
    model_ = KeptModel{path, variant, std::move(model)};
}

bool EditSession::has_prior(const EditRequest& request, const PriorUse& use) const {
    if (!prior_.valid()) return false;
    const PriorNeeds needs = needs_of(request, plans_, use);
    nlohmann::json key = key_of(request, use);
    // A prior with a decoder also serves edits that need none.
    key["decoder"] = needs.decoder || prior_key_.value("decoder", false);
    return prior_key_ == key && can_serve(prior_, needs);
}

std::shared_future<std::shared_ptr<const DiffusionModel>> EditSession::prior(
    const EditRequest& request, const PriorUse& use) {
    const PriorNeeds needs = needs_of(request, plans_, use);
    if (!has_prior(request, use)) {
        prior_key_ = key_of(request, use);
        prior_key_["decoder"] = needs.decoder;
        prior_ = {};  // releases the previous prior first
        prior_ = std::async(std::launch::async, load_networks, request, needs).share();
    }
    const auto make_ready = [loading = prior_, request, needs, low = use.low_memory] {
        std::shared_ptr<DiffusionModel> prior = loading.get();
        if (auto* running = dynamic_cast<RunningPipeline*>(prior.get())) {
            running->learn_prompts(needs.sentences);
            prior = std::make_shared<RunningPipeline>(running->renewed());
        }
        make_prior_ready(*prior, request.plan, low);
        return std::shared_ptr<const DiffusionModel>(prior);
    };
    return std::async(std::launch::async, make_ready).share();
}

std::shared_future<std::string> EditSession::prior_hash(const std::filesystem::path& prior) {
    if (!hash_.valid() || hashed_ != prior) {
        hash_ = std::async(std::launch::async, hash_of_weights, prior).share();
        hashed_ = prior;
    }
    return hash_;
}

std::shared_ptr<const Captioner> EditSession::captioner(const EditRequest& request,
                                                        at::ScalarType precision) {
    if (!request.plan.asks_captioner) return nullptr;
    if (!captioner_) captioner_ = load_wanted_captioner(request, precision);
    return captioner_;
}

std::shared_ptr<const Clip> EditSession::clip(const std::filesystem::path& folder) {
    if (!clip_ && !folder.empty()) clip_ = std::make_shared<const Clip>(Clip::load(folder));
    return clip_;
}

std::shared_ptr<LightRig> EditSession::lights(const EditPlan& plan, at::Device device) {
    const nlohmann::json key{plan.light, static_cast<int>(plan.light_variation),
                             plan.light_cube_size, device.str()};
    constexpr std::size_t max_lights = 8;
    if (lights_.size() >= max_lights && !lights_.contains(key.dump())) lights_.clear();
    std::shared_ptr<LightRig>& rig = lights_[key.dump()];
    if (!rig)
        rig = std::make_shared<LightRig>(plan.light, plan.light_variation, plan.light_cube_size,
                                         device);
    return rig;
}

}  // namespace item3d
