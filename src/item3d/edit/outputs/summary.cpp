#include "item3d/edit/outputs/summary.h"

#include "item3d/baselines/methods.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"
#include "item3d/edit/outputs/edit_claim.h"
#include "item3d/edit/painting/painting.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"
#include "item3d/report/animation.h"
#include "item3d/tensors/precision.h"
#include "item3d/tensors/tensor.h"

#include <ATen/Parallel.h>

#include <cmath>

namespace item3d {
namespace {

using nlohmann::json;

json means_json(const SurfaceMeans& means) {
    return {{"base_color_linear", {means.base_color.x, means.base_color.y, means.base_color.z}},
            {"roughness", means.roughness},
            {"metallic", means.metallic}};
}

std::string hex_color(const Vec3& linear) {
    const auto byte = [](float value) {
        return static_cast<int>(
            std::lround(255.0f * linear_to_srgb(std::clamp(value, 0.0f, 1.0f))));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(linear.x), byte(linear.y), byte(linear.z));
}

json seconds_json(const StageTimes& times) {
    json seconds = json::object();
    for (const auto& [stage, value] : times.stages())
        seconds[stage] = value;
    seconds["total"] = times.total();
    return seconds;
}

json iteration_json(const IterationTimes& times, bool several_processes) {
    const auto count = static_cast<double>(std::max<std::int64_t>(1, times.iterations));
    json result = {{"render", times.render / count}, {"encode", times.encode / count},
                   {"unet", times.unet / count},     {"backward", times.backward / count},
                   {"step", times.step / count},     {"adjust", times.adjust / count}};
    if (several_processes) result["exchange"] = times.exchange / count;
    return result;
}

json adjustment_json(const EditRequest& request, const AdjustmentState& adjustment) {
    json result = {{"records", adjustment.records}};
    if (request.plan.asks_captioner) {
        result["captioner"] = request.captioner.string();
        json before = json::array();
        for (const Caption& caption : adjustment.captions_before)
            before.push_back(caption.text);
        result["captions_before"] = before;
    }
    if (!adjustment.failure.empty()) result["failure"] = adjustment.failure;
    return result;
}

/// Removes those settings of guidance that the method does not use.
void leave_out_unused(json& summary, const std::string& method) {
    const bool paints = paints_views(method);
    if (!paints && method != "clip" && method != "in2n") return;
    summary.erase("guidance");
    json& settings = summary["settings"];
    for (const char* name : {"guidance", "adjust", "adjust_every", "adjust_strength",
                             "adjust_learning_rate", "adjust_samples", "anchor"})
        settings.erase(name);
    if (paints) settings.erase("settle");
}

json summary_json(const EditRequest& request, const EditScene& scene, const EditState& state,
                  const StageTimes& times, const IterationTimes& iteration_times,
                  const EditImages& images) {
    const EditPlan& plan = request.plan;
    json remade = json::object();
    for (const TextureSet& set : scene.atlas.sets) {
        for (const int material : set.materials) {
            if (!set.is_own())
                remade[scene.model.materials[static_cast<std::size_t>(material)].name] = set.remade;
        }
    }
    json summary = {
        {"version", version()},
        {"command", request.command},
        {"model", request.model.string()},
        {"from", plan.from},
        {"to", plan.to},
        {"read_as", {{"from", scene.from}, {"to", scene.to}}},
        {"prior", request.prior.string()},
        {"method", plan.method},
        {"guidance", plan.guidance},
        {"seed", plan.seed},
        {"device", scene.device.is_cuda() ? "cuda" : "cpu"},
        {"precision", precision_name(scene.precision)},
        {"threads", at::get_num_threads()},
        {"processes", request.processes.size()},
        {"iterations", plan.iterations},
        {"iterations_done", state.direction_length.size()},
        {"unet_rows", state.unet_rows()},
        {"adjustment", adjustment_json(request, state.adjustment)},
        {"settings", plan},
        {"claim", claim_of(request, state)},
        {"new_uv_maps", remade},
        {"scores",
         {{"detail_kept", images.detail_kept},
          {"before", means_json(images.means_before)},
          {"after", means_json(images.means_after)}}},
        {"seconds", seconds_json(times)},
        {"seconds_per_iteration", iteration_json(iteration_times, request.processes.several())},
        {"peak_memory_bytes", peak_memory_bytes()}};
    leave_out_unused(summary, plan.method);
    if (!scene.model.variants.empty() && plan.edits_texture) {
        summary["variants"] = {{"changed", variants_with(scene.model, scene.materials, true)},
                               {"left", variants_with(scene.model, scene.materials, false)}};
    }
    if (state.painter) {
        summary["views"] = json::array();
        for (std::size_t i = 0; i < state.painter->images().size(); ++i)
            summary["views"].push_back(painted_view_file(i));
    }
    if (scene.region)
        summary["region"] = {
            {"share", scene.region->share()},
            {"outside",
             {{"texels", images.outside.compared}, {"changed", images.outside.changed}}}};
    if (images.clip) {
        json clip = images.clip->mean;
        clip["model"] = request.clip.string();
        clip["views"] = images.clip->views;
        summary["scores"]["clip"] = std::move(clip);
    }
    return summary;
}

std::vector<Score> scores_of(const EditImages& images) {
    const SurfaceMeans& before = images.means_before;
    const SurfaceMeans& after = images.means_after;
    std::vector<Score> scores = {
        {"Mean base colour", hex_color(after.base_color), "was " + hex_color(before.base_color)},
        {"Metallic", fmt::format("{:.2f}", after.metallic),
         fmt::format("was {:.2f}; 1 is bare metal", before.metallic)},
        {"Roughness", fmt::format("{:.2f}", after.roughness),
         fmt::format("was {:.2f}; 0 is a mirror", before.roughness)},
        {"Detail kept", fmt::format("{:.2f}", images.detail_kept),
         "correlation of luminance detail before and after; 1 keeps every line"}};
    if (images.clip) {
        const ClipScore& clip = images.clip->mean;
        scores.push_back(
            {"CLIP, target", fmt::format("{:.3f}", clip.global),
             fmt::format("was {:.3f}; cosine of images and target sentence", clip.global_before)});
        scores.push_back({"CLIP, direction", fmt::format("{:.3f}", clip.directional),
                          "cosine of the change in the images and the change in the sentence"});
    }
    return scores;
}

Curve curve_of(const std::string& name, const std::vector<float>& values) {
    return {name, std::vector<double>(values.begin(), values.end()), 1, 1};
}

std::string timeline_note(const EditState& state) {
    if (state.painter)
        return "Views as generated by the prior, before they were projected onto the model.";
    std::string text = "direction: its mean length since the previous image";
    if (state.guidance->text_direction())
        text +=
            "; turned, length: angle and length of the direction between the two sentences, "
            "relative to the initial one; loss: mean denoising loss of the source since the "
            "previous image";
    return text + ".";
}

std::vector<Chart> charts_of(const EditPlan& plan, const EditState& state) {
    if (state.direction_length.empty()) return {};
    std::vector<Chart> charts;
    const bool has_loss = plan.method == "clip" || plan.method == "in2n";
    charts.push_back({has_loss                 ? "Loss"
                      : plan.guidance == "sds" ? "Length of the score"
                                               : "Length of the direction",
                      "iteration",
                      {curve_of(has_loss ? "loss" : "direction", state.direction_length)},
                      true});
    if (state.guidance->text_direction()) {
        charts.push_back({plan.adjust == Adjustment::off ? "Denoising loss of the source sentence"
                                                         : "Denoising loss of the adjusted source",
                          "iteration",
                          {curve_of("loss", state.source_loss)},
                          true});
    }
    return charts;
}

/// Makes a timeline entry with the first caption only. edit.json has all captions.
TimelineEntry entry_of(const AdjustmentRecord& record) {
    TimelineEntry entry;
    entry.title = record.iteration == 0 ? "start" : fmt::format("step {}", record.iteration);
    entry.image = {entry.title, encode_webp(to_image(record.image.to(at::kFloat) / 255))};
    if (!record.captions.empty()) entry.caption = record.captions.front();
    if (record.direction)
        entry.facts.emplace_back("direction", fmt::format("{:.3f}", *record.direction));
    if (record.text) {
        entry.facts.emplace_back("turned", fmt::format("{:.0f}\u00b0", record.text->angle));
        entry.facts.emplace_back("length", fmt::format("{:.2f}", record.text->length));
    }
    if (record.source_loss)
        entry.facts.emplace_back("loss", fmt::format("{:.3f}", *record.source_loss));
    return entry;
}

/// Returns at most max_entries entries, among them the first and the last.
std::vector<TimelineEntry> timeline_of(const std::vector<AdjustmentRecord>& records) {
    constexpr std::size_t max_entries = 12;
    const std::size_t count = std::min(records.size(), max_entries);
    std::vector<TimelineEntry> timeline;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t index = count < 2 ? i : i * (records.size() - 1) / (count - 1);
        timeline.push_back(entry_of(records[index]));
    }
    return timeline;
}

std::vector<TimelineEntry> painted_views(const ViewPainter& painter) {
    constexpr std::size_t max_views = 12;
    const auto& images = painter.images();
    std::vector<TimelineEntry> timeline;
    for (std::size_t i = 0; i < std::min(images.size(), max_views); ++i) {
        TimelineEntry entry;
        entry.title = fmt::format("view {}", i + 1);
        entry.image = {entry.title, encode_webp(to_image(images[i][0].permute({1, 2, 0})))};
        timeline.push_back(std::move(entry));
    }
    return timeline;
}

TableRows settings_rows(const json& summary) {
    TableRows rows;
    for (const auto& [key, value] : summary["settings"].items()) {
        // An empty list of materials means all.
        const bool all = key == "material" && value.empty();
        rows.emplace_back(key, all ? "all" : readable(value));
    }
    for (const char* key : {"prior", "device", "precision", "threads"}) {
        rows.emplace_back(key, readable(summary[key]));
    }
    rows.emplace_back("peak memory",
                      fmt::format("{:.0f} MB", summary["peak_memory_bytes"].get<double>() / 1e6));
    return rows;
}

}  // namespace

json write_summary(const EditRequest& request, const EditScene& scene, const EditState& state,
                   const StageTimes& times, const IterationTimes& iteration_times,
                   const EditedModel& edited, const EditImages& images) {
    const json summary = summary_json(request, scene, state, times, iteration_times, images);

    EditReport report;
    report.model = request.model.filename().string();
    report.from = request.plan.from;
    report.to = request.plan.to;
    if (!state.painter &&
        state.direction_length.size() < static_cast<std::size_t>(request.plan.iterations))
        report.summary = fmt::format("Converged after {} of {} iterations.",
                                     state.direction_length.size(), request.plan.iterations);
    report.before = images.before;
    report.after = images.after;
    report.turntable = images.turntable;
    if (scene.region) {
        report.region = images.region;
        const std::string outside =
            images.outside.compared > 0
                ? fmt::format("Outside the region, {} of {} texels changed.",
                              images.outside.changed, images.outside.compared)
                : "The model had no texture to compare the texels outside the region with.";
        report.region_note =
            fmt::format("The region, in orange, is {:.1f} % of the edited materials' surface. {}",
                        100 * scene.region->share(), outside);
    }
    report.textures = edited.textures;
    report.scores = scores_of(images);
    report.timeline =
        state.painter ? painted_views(*state.painter) : timeline_of(state.adjustment.records);
    report.timeline_note = timeline_note(state);
    report.charts = charts_of(request.plan, state);
    report.settings = settings_rows(summary);
    report.seconds = times.stages();
    for (const auto& [name, reason] : summary["new_uv_maps"].items())
        report.warnings.push_back("Material " + name +
                                  " has a new UV map: " + reason.get<std::string>());
    if (!state.adjustment.failure.empty())
        report.warnings.push_back("Captions stopped during the edit: " + state.adjustment.failure);
    const std::string model_file = model_file_name(request.model);
    report.files = {{model_file, model_file},
                    {"edit.json", "edit.json"},
                    {"before.png", "before.png"},
                    {"after.png", "after.png"}};
    if (images.turntable) report.files.emplace_back("turntable.webp", "turntable.webp");
    if (request.plan.edits_texture && !state.painter)
        report.files.emplace_back("layer.safetensors", "layer.safetensors");
    if (edited.light) report.files.push_back({"light.exr", "light.exr"});
    report.command = request.command;
    report.version = version();
    write_atomically(request.output / "report.html", edit_report_html(report));
    write_atomically(request.output / "edit.json", summary.dump(2) + "\n");
    return summary;
}

}  // namespace item3d
