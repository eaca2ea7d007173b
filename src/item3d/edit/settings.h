// What an edit does, in one value that goes into edit.json, the report, and the checkpoint.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Every setting that changes the result. Defaults are for Stable Diffusion at 512 pixels; a prior
/// brings its own in prior.json ("defaults"), and the command line overrides both. What is added to
/// the prior is among them, under its own names.
struct EditSettings : PipelineExtras {
    std::string from;
    std::string to;
    /// What the picture shall not show: for the guidance (but rdl's) and the detail stage.
    std::string negative_prompt;
    std::string guidance = "rdl";
    std::string adjust = "learned";
    float anchor = 0.0f;
    float cfg = 7.5f;  ///< weight of classifier-free guidance
    float adjust_learning_rate = 0.03f;
    int adjust_samples = 1;  ///< noises that each step of the learned source looks at
    /// Iterations between captions, and between lines of the record.
    int adjust_every = 25;
    float adjust_strength = 1;  ///< how much captions count
    /// The optimisation ends where the direction has shrunk to this part of its first length, see
    /// fixed_point.h; 0: never before the last iteration.
    float settle = 0;
    int fit_steps = 200;  ///< that make the neural texture look like the model's own materials
    int iterations = 600;
    /// Instead of these, where a texture is edited and the detail stage follows, which paints anew
    /// what they made of the base colour. 0: as many as without it.
    int iterations_before_detail = 0;
    int batch = 2;         ///< views an iteration
    int resolution = 512;  ///< pixels of the square picture that the prior sees
    float learning_rate = 0.01f;
    /// How strongly an edit that names nothing with a pattern is held to recolour evenly
    /// (evenness.h); 0: not at all.
    float evenness = 0;
    std::string metallic = "auto";  ///< auto: edited where a prompt names a metal; or always
    /// Where the target names a metal and the source does not; 1 - this where only the source does.
    float metallic_start = 0.5f;
    /// The detail stage (optimize.h) after the iterations. auto: where the target sentence has one
    /// of `detail_words` that the source has not; or off, or always.
    std::string detail = "auto";
    std::vector<std::string> detail_words;  ///< lower case; the prior's own list
    int detail_views = 20;
    std::vector<float> timesteps = {0.02f, 0.98f};
    std::string timestep_schedule = "uniform";
    std::string weighting = "dreamfusion";
    std::string light = "studio";      ///< preset or .hdr/.exr file
    std::string optimize = "texture";  ///< texture, light, or both
    std::string light_model = "auto";  ///< physical, texels; auto: physical for small pictures
    float light_learning_rate = 0.05f;
    /// Azimuth and elevation in degrees (SkyAngles) that a light being optimised must come from;
    /// empty: from anywhere.
    std::vector<float> light_from;
    /// How the light varies while a texture is edited: off, rotate, or all (views.h).
    std::string light_augment = "all";
    std::string background = "vary";  ///< a colour, or "vary": another grey each iteration
    int texture_size = 0;             ///< 0: as the input, or 1024 where it has no texture
    std::vector<std::string> keep = {"occlusion", "normal"};
    std::vector<std::string> material;  ///< names; empty: all
    std::uint64_t seed = 0;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(
    EditSettings, lora, embedding, controlnet, controlnet_scale, vae, from, to, negative_prompt,
    guidance, adjust, anchor, cfg, adjust_learning_rate, adjust_samples, adjust_every,
    adjust_strength, settle, fit_steps, iterations, iterations_before_detail, batch, resolution,
    learning_rate, evenness, metallic, metallic_start, detail, detail_words, detail_views,
    timesteps, timestep_schedule, weighting, light, optimize, light_model, light_learning_rate,
    light_from, light_augment, background, texture_size, keep, material, seed)

/// "defaults" of PRIOR/prior.json; an empty object where it has none. Throws InputError.
nlohmann::json prior_defaults(const std::filesystem::path& prior);

/// Built-in defaults <- "defaults" of PRIOR/prior.json (if there) <- what relighting needs, where
/// the overrides say to optimise the light alone <- what a method was published with, where the
/// overrides name it <- overrides; then `iterations` <- `iterations_before_detail`, where that is
/// meant and the overrides have no iterations. Throws InputError when a value is of the wrong type
/// or out of range.
EditSettings resolve_settings(const std::filesystem::path& prior, const nlohmann::json& overrides);

/// Whether a captioner adjusts the direction.
bool wants_captions(const EditSettings& settings);
/// Whether a light, or a texture, is among what is optimised.
bool edits_light(const EditSettings& settings);
bool edits_texture(const EditSettings& settings);

/// Whether the target sentence has one of `detail_words` that the source has not.
bool names_detail(const EditSettings& settings);

/// Whether the detail stage runs.
bool wants_detail(const EditSettings& settings);

GuidanceOptions guidance_options(const EditSettings& settings);

}  // namespace item3d
