#include "item3d/edit/optimize/adjustment.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/edit/optimize/render_view.h"

#include <algorithm>
#include <numeric>

namespace item3d {
namespace {

constexpr int caption_views = 4;  ///< number of views whose captions are averaged

/// Returns the image size for captions: that of the prior, within limits. Captioners are faster on
/// small images and more accurate on large ones.
int caption_pixels(const EditPlan& plan) {
    return std::clamp(plan.resolution, 144, 384);
}

/// Returns the mean over the iterations since the previous record. Returns no value if there were
/// none.
std::optional<double> recent_mean(const std::vector<float>& curve,
                                  const std::vector<AdjustmentRecord>& records) {
    const auto begin = records.empty() ? 0 : records.back().iteration;
    if (begin >= static_cast<std::int64_t>(curve.size())) return std::nullopt;
    const auto first = curve.begin() + begin;
    return std::accumulate(first, curve.end(), 0.0) / static_cast<double>(curve.end() - first);
}

/// Converts [N, H, W, 3] in [0, 1] to N CPU tensors of bytes [H, W, 3].
std::vector<at::Tensor> to_bytes(const at::Tensor& images) {
    return (images * 255).round().to(at::kByte).cpu().unbind(0);
}

}  // namespace

DirectionAdjustment::DirectionAdjustment(const EditRequest& request, const EditScene& scene)
    : plan_(request.plan),
      scene_(scene),
      processes_(request.processes),
      cameras_(field_cameras(scene, caption_views)) {
    if (!scene.captioner) return;
    source_.emplace(
        scene.prior(), plan_.from, plan_.to,
        CaptionSourceOptions{plan_.adjust_strength, plan_.adjust == Adjustment::caption_paper});
}

void DirectionAdjustment::before_iteration(EditState& state) const {
    if (state.iteration % plan_.adjust_every == 0) observe(state);
}

void DirectionAdjustment::finish(EditState& state) const {
    const auto& records = state.adjustment.records;
    const auto done = static_cast<std::int64_t>(state.direction_length.size());
    if (done > 0 && (records.empty() || records.back().iteration < done)) observe(state);
}

void DirectionAdjustment::observe(EditState& state) const {
    std::vector<AdjustmentRecord>& records = state.adjustment.records;
    const bool asks = source_ && state.adjustment.failure.empty();
    AdjustmentRecord record;
    record.iteration = static_cast<std::int64_t>(state.direction_length.size());
    record.direction = recent_mean(state.direction_length, records);
    record.source_loss = recent_mean(state.source_loss, records);
    std::optional<TextEmbedding> shift;
    if (processes_.first()) {
        // Without a captioner, only the first view is needed, for the record.
        const std::vector<Camera> cameras(cameras_.begin(),
                                          asks ? cameras_.end() : cameras_.begin() + 1);
        const at::Tensor images = draw_field(scene_, state.field, current_light(scene_, state),
                                             cameras, caption_pixels(plan_));
        record.image = to_bytes(images).front();
        if (asks) shift = follow(state, images, record.captions);
    }
    if (source_) shift = handed_on(shift);
    if (shift) state.guidance->shift_source(*shift);
    record.text = state.guidance->text_direction();
    if (!record.text) record.source_loss.reset();
    records.push_back(std::move(record));
}

/// Returns the first process's shift on all processes.
std::optional<TextEmbedding> DirectionAdjustment::handed_on(
    const std::optional<TextEmbedding>& shift) const {
    if (!processes_.several()) return shift;
    NamedTensors tensors;
    if (shift) tensors.emplace_back("states", shift->states.cpu());
    if (shift && shift->pooled.defined()) tensors.emplace_back("pooled", shift->pooled.cpu());
    tensors = processes_.broadcast(tensors);
    if (tensors.empty()) return std::nullopt;
    TextEmbedding all{tensors[0].second.to(scene_.device)};
    if (tensors.size() > 1) all.pooled = tensors[1].second.to(scene_.device);
    return all;
}

std::optional<TextEmbedding> DirectionAdjustment::follow(EditState& state, const at::Tensor& images,
                                                         std::vector<std::string>& said) const {
    AdjustmentState& adjustment = state.adjustment;
    std::vector<Caption> captions;
    try {
        if (adjustment.captions_before.empty())
            adjustment.captions_before = scene_.captioner->captions(
                to_bytes(draw_field(scene_, state.fitted,
                                    state.light ? state.first_light : scene_.lights->front(),
                                    cameras_, caption_pixels(plan_))),
                {});
        captions = scene_.captioner->captions(to_bytes(images), {});
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        give_up(adjustment, error.what());
        return std::nullopt;
    }
    for (const Caption& caption : captions)
        said.push_back(caption.text);
    const auto shift = source_->shift(adjustment.captions_before, captions);
    if (!shift)
        give_up(adjustment, "the captioner returned an empty caption, or one without an end");
    return shift;
}

void DirectionAdjustment::give_up(AdjustmentState& state, const std::string& reason) const {
    state.failure = reason.substr(0, reason.find('\n'));
    warn("captions stop, the source is no longer adjusted: " + state.failure);
}

}  // namespace item3d
