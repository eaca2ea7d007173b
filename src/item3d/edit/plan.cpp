#include "item3d/edit/plan.h"

#include "item3d/baselines/methods.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/words.h"
#include "item3d/edit/setting.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace item3d {
namespace {

/// Largest resolution, in pixels, of a small prior. Such a prior resolves little of a light and
/// needs no sharp reflections. Its input is rendered at twice the size and averaged, as were the
/// training images of the embedded prior.
constexpr int small_prior_pixels = 128;

/// Words for metals, sorted.
constexpr std::array<std::string_view, 29> metal_words = {
    "alloy",  "aluminium", "aluminum", "brass",    "bronze",   "chrome", "chromed",  "chromium",
    "cobalt", "copper",    "foil",     "gilded",   "gilt",     "gold",   "golden",   "iron",
    "metal",  "metallic",  "nickel",   "pewter",   "platinum", "silver", "silvered", "silvery",
    "steel",  "tin",       "titanium", "tungsten", "zinc"};

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// True if the target sentence has one of `detail_words` that the source lacks.
bool names_detail(const EditSettings& settings) {
    const std::vector<std::string> from = prompt_words(settings.from);
    const std::vector<std::string> to = prompt_words(settings.to);
    return std::any_of(settings.detail_words.begin(), settings.detail_words.end(),
                       [&](const std::string& word) { return has(to, word) && !has(from, word); });
}

ChannelMask edited_channels(const EditSettings& settings) {
    if (settings.optimize == Optimize::light) return {false, false, false, false, false};
    const auto edited = [&](const char* name) { return !has(settings.keep, name); };
    const bool metal = settings.metallic == Metallic::always || names_metal(settings.from) ||
                       names_metal(settings.to);
    return {edited("base_color"), edited("occlusion"), edited("roughness"),
            edited("metallic") && metal, edited("normal")};
}

LightKind resolved_kind(LightChoice choice, bool small_prior) {
    switch (choice) {
        case LightChoice::physical:
            return LightKind::physical;
        case LightChoice::texels:
            return LightKind::texels;
        case LightChoice::automatic:
            break;
    }
    return small_prior ? LightKind::physical : LightKind::texels;
}

/// Returns the guidance scale and the noise levels with which a method was published. The defaults
/// are those of rdl and sds.
nlohmann::json published_settings(const std::string& method) {
    if (method == "dds") return {{"timesteps", {0.05, 0.95}}};
    // The published cfg is 100, for neural radiance fields.
    if (method == "pds") return {{"cfg", 30}, {"timesteps", {0.1, 0.9}}};
    if (method == "sdi")
        return {{"cfg", 8.5}, {"timesteps", {0.25, 0.98}}, {"timestep_schedule", "anneal"}};
    return nlohmann::json::object();
}

/// Returns the settings for relighting. A light has few parameters, each of which changes the whole
/// image, so it needs fewer steps than a texture. The guidance is dds, whose direction is relative
/// to the same view in the initial light. This cancels the gradient that the prior would give for
/// the model itself.
nlohmann::json relight_settings() {
    return {{"guidance", "dds"}, {"iterations", 80}};
}

EditSettings merge_settings(const std::filesystem::path& prior, const nlohmann::json& overrides) {
    nlohmann::json merged = EditSettings{};
    merged.update(prior_defaults(prior));
    if (overrides.get<EditSettings>().optimize == Optimize::light) {
        merged.update(relight_settings());
        merged.update(published_settings(merged["guidance"]));
    }
    merged.update(published_settings(overrides.value("guidance", "")));
    if (overrides.contains("method")) {
        rows::find_choice("--method", edit_method_names(), overrides.at("method"));
        merged.update(method_settings(overrides.at("method")));
    }
    merged.update(overrides);
    return merged.get<EditSettings>();
}

}  // namespace

EditPlan::EditPlan(EditSettings settings) : EditSettings(std::move(settings)) {
    const bool is_whole = region.empty() || region == std::vector<std::string>{"all"};
    if (optimize == Optimize::light && !(is_whole && exclude.empty()))
        throw InputError(
            is_whole ? "--exclude" : "--region",
            "has no effect with --optimize light, since the light shines on the whole model",
            "leave one of them out");
    const bool small_prior = resolution <= small_prior_pixels;
    const bool target_names_detail = names_detail(*this);
    paints_views = item3d::paints_views(method);
    if (paints_views) iterations = 0;
    edits_texture = optimize != Optimize::light;
    edits_light = optimize != Optimize::texture;
    asks_captioner = !paints_views && guidance == "rdl" && adjusts_by_captions(adjust);
    regularizes_color = evenness > 0 && !paints_views && edits_texture && !target_names_detail;
    paints_detail = iterations > 0 && edits_texture && !has(keep, "base_color") &&
                    (detail == Detail::automatic ? target_names_detail : detail == Detail::always);
    total_iterations = paints_views ? painter_steps(method, painter_options())
                                    : iterations + (paints_detail ? detail_views : 0);
    channels = edited_channels(*this);
    if (paints_views) channels = {channels.base_color, false, false, false, false};
    light_kind = resolved_kind(light_model, small_prior);
    light_variation = edits_light ? LightAugment::off : light_augment;
    light_cube_size = small_prior ? 64 : 256;
    supersampling = small_prior ? 2 : 1;
}

GuidanceOptions EditPlan::guidance_options() const {
    GuidanceOptions options;
    options.method = guidance;
    options.adjust = adjust;
    options.guidance_scale = cfg;
    options.negative_prompt = negative_prompt;
    options.anchor = anchor;
    options.adjust_learning_rate = adjust_learning_rate;
    options.adjust_samples = adjust_samples;
    options.min_timestep = timesteps[0];
    options.max_timestep = timesteps[1];
    options.timestep_schedule = timestep_schedule;
    options.iterations = iterations;
    options.weighting = weighting;
    options.seed = seed;
    return options;
}

PainterOptions EditPlan::painter_options() const {
    return {steps, views, cfg, seed};
}

DatasetUpdateOptions EditPlan::dataset_update_options() const {
    DatasetUpdateOptions options;
    options.instruction = instruction.empty() ? "turn it into " + to : instruction;
    options.negative_prompt = negative_prompt;
    options.scales = {cfg, image_cfg};
    if (views > 0) options.views = views;
    if (steps > 0) options.steps = steps;
    options.min_timestep = timesteps[0];
    options.max_timestep = timesteps[1];
    options.seed = seed;
    return options;
}

nlohmann::json prior_defaults(const std::filesystem::path& prior) {
    const auto path = prior / "prior.json";
    if (!std::filesystem::exists(path)) return nlohmann::json::object();
    const auto document = parse_json(read_text(path));
    if (!document.is_object()) {
        throw InputError(path.string(), "is not a JSON object",
                         "download or train the prior again");
    }
    return document.value("defaults", nlohmann::json::object());
}

EditPlan resolve_plan(const std::filesystem::path& prior, const nlohmann::json& overrides) {
    try {
        EditSettings settings = merge_settings(prior, overrides);
        check_settings(settings);
        EditPlan plan(settings);
        const bool given = overrides.contains("iterations");
        if (given || settings.iterations_before_detail == 0 || plan.edits_light ||
            !plan.paints_detail)
            return plan;
        settings.iterations = settings.iterations_before_detail;
        return EditPlan(settings);
    } catch (const nlohmann::json::exception& error) {
        throw InputError((prior / "prior.json").string(),
                         std::string("a value in \"defaults\" has the wrong type: ") + error.what(),
                         "correct it, or get the prior again");
    }
}

bool names_metal(const std::string& prompt) {
    const std::vector<std::string> words = prompt_words(prompt);
    return std::any_of(words.begin(), words.end(), [](const std::string& word) {
        return std::binary_search(metal_words.begin(), metal_words.end(), word);
    });
}

}  // namespace item3d
