#include "item3d/edit/settings.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/words.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

using nlohmann::json;

/// What a method needs that is not usual: guidance scales, noise levels. rdl and sds are what the
/// other defaults are for.
json published_settings(const std::string& method) {
    if (method == "dds") return {{"timesteps", {0.05, 0.95}}};
    // cfg is published as 100, for neural radiance fields.
    if (method == "pds") return {{"cfg", 30}, {"timesteps", {0.1, 0.9}}};
    if (method == "sdi")
        return {{"cfg", 8.5}, {"timesteps", {0.25, 0.98}}, {"timestep_schedule", "anneal"}};
    return json::object();
}

/// A light has few numbers, and they move the whole picture: fewer steps than for a texture, and a
/// direction that is taken against the same picture in the first light, which cancels what the
/// prior makes of the model itself.
json relight_settings() {
    return {{"guidance", "dds"}, {"iterations", 80}};
}

void require(bool condition, const std::string& option, const std::string& problem) {
    if (!condition) throw InputError(option, problem);
}

void check(const EditSettings& settings) {
    require(settings.fit_steps >= 1, "fit_steps", "must be 1 or more");
    require(settings.iterations >= 0, "--iterations", "must be 0 or more");
    require(settings.iterations_before_detail >= 0, "iterations_before_detail",
            "must be 0 or more");
    require(settings.batch >= 1 && settings.batch <= 64, "--batch", "must be between 1 and 64");
    require(settings.resolution >= 16 && settings.resolution <= 2048, "--resolution",
            "must be between 16 and 2048 pixels");
    require(settings.learning_rate > 0, "--learning-rate", "must be above 0");
    require(settings.evenness >= 0 && settings.evenness <= 1e9f, "--evenness",
            "must be between 0 (blotches stay) and 1e9");
    require(settings.optimize == "texture" || settings.optimize == "light" ||
                settings.optimize == "both",
            "--optimize", "must be texture, light or both");
    require(settings.light_model == "auto" || settings.light_model == "physical" ||
                settings.light_model == "texels",
            "--light-model", "must be auto, physical or texels");
    require(settings.light_augment == "off" || settings.light_augment == "rotate" ||
                settings.light_augment == "all",
            "--light-augment", "must be off, rotate or all");
    require(settings.light_learning_rate > 0, "light_learning_rate", "must be above 0");
    require(settings.light_from.empty() || settings.light_from.size() == 2, "light_from",
            "must be an azimuth and an elevation in degrees");
    require(settings.metallic == "auto" || settings.metallic == "always", "--metallic",
            "must be auto or always");
    require(settings.metallic_start >= 0 && settings.metallic_start <= 1, "metallic_start",
            "must be between 0 and 1");
    require(settings.detail == "auto" || settings.detail == "off" || settings.detail == "always",
            "--detail", "must be auto, off or always");
    require(settings.detail_views >= 1 && settings.detail_views <= 1000, "detail_views",
            "must be between 1 and 1000");
    require(settings.adjust_samples >= 1 && settings.adjust_samples <= 64, "adjust_samples",
            "must be between 1 and 64");
    require(settings.adjust_every >= 1 && settings.adjust_every <= 1000000, "--adjust-every",
            "must be 1 or more iterations");
    require(settings.adjust_strength >= 0 && settings.adjust_strength <= 2, "--adjust-strength",
            "must be between 0 and 2");
    require(settings.settle >= 0 && settings.settle < 1, "--settle",
            "must be between 0 (never) and 1");
    require(settings.texture_size >= 0 && settings.texture_size <= 8192, "--texture-size",
            "must be between 1 and 8192, or 0 for the input's own");
    require(settings.timesteps.size() == 2 && settings.timesteps[0] >= 0 &&
                settings.timesteps[0] < settings.timesteps[1] && settings.timesteps[1] <= 1,
            "--timesteps", "must be two rising numbers between 0 and 1, as in 0.02,0.98");
    constexpr std::array channels = {"base_color", "occlusion", "roughness", "metallic", "normal"};
    for (const std::string& channel : settings.keep) {
        require(std::find(channels.begin(), channels.end(), channel) != channels.end(), "--keep",
                fmt::format("'{}' is not a channel; choose from {}", channel,
                            fmt::join(channels, ", ")));
    }
}

}  // namespace

json prior_defaults(const std::filesystem::path& prior) {
    const auto path = prior / "prior.json";
    if (!std::filesystem::exists(path)) return json::object();
    const json document = json::parse(read_text(path), nullptr, false);
    if (!document.is_object()) {
        throw InputError(path.string(), "is not a JSON object", "fetch or train the prior again");
    }
    return document.value("defaults", json::object());
}

EditSettings resolve_settings(const std::filesystem::path& prior, const json& overrides) {
    json merged = EditSettings{};
    merged.update(prior_defaults(prior));
    if (overrides.value("optimize", "") == "light") {
        merged.update(relight_settings());
        merged.update(published_settings(merged["guidance"]));
    }
    merged.update(published_settings(overrides.value("guidance", "")));
    merged.update(overrides);
    try {
        EditSettings settings = merged.get<EditSettings>();
        check(settings);
        const bool given = overrides.contains("iterations");
        if (!given && settings.iterations_before_detail > 0 && !edits_light(settings) &&
            wants_detail(settings))
            settings.iterations = settings.iterations_before_detail;
        return settings;
    } catch (const json::exception& error) {
        throw InputError((prior / "prior.json").string(),
                         std::string("its defaults are of the wrong kind: ") + error.what());
    }
}

bool wants_captions(const EditSettings& settings) {
    return settings.guidance == "rdl" && adjusts_by_captions(settings.adjust);
}

bool edits_light(const EditSettings& settings) {
    return settings.optimize != "texture";
}

bool edits_texture(const EditSettings& settings) {
    return settings.optimize != "light";
}

bool names_detail(const EditSettings& settings) {
    const auto has = [](const std::vector<std::string>& words, const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    const std::vector<std::string> from = prompt_words(settings.from);
    const std::vector<std::string> to = prompt_words(settings.to);
    return std::any_of(settings.detail_words.begin(), settings.detail_words.end(),
                       [&](const std::string& word) { return has(to, word) && !has(from, word); });
}

bool wants_detail(const EditSettings& settings) {
    const auto& kept = settings.keep;
    if (settings.iterations == 0 || !edits_texture(settings)) return false;
    if (std::find(kept.begin(), kept.end(), "base_color") != kept.end()) return false;
    return settings.detail == "auto" ? names_detail(settings) : settings.detail == "always";
}

GuidanceOptions guidance_options(const EditSettings& settings) {
    GuidanceOptions options;
    options.method = settings.guidance;
    options.adjust = settings.adjust;
    options.guidance_scale = settings.cfg;
    options.negative_prompt = settings.negative_prompt;
    options.anchor = settings.anchor;
    options.adjust_learning_rate = settings.adjust_learning_rate;
    options.adjust_samples = settings.adjust_samples;
    options.min_timestep = settings.timesteps[0];
    options.max_timestep = settings.timesteps[1];
    options.timestep_schedule = parse_timestep_schedule(settings.timestep_schedule);
    options.iterations = settings.iterations;
    options.weighting = parse_weighting(settings.weighting);
    options.seed = settings.seed;
    return options;
}

}  // namespace item3d
