// The settings of an edit. edit.json, the report and the checkpoint store them.
#pragma once

#include "item3d/baselines/clip_guidance.h"
#include "item3d/field/atlas/atlas.h"
#include "item3d/guidance/guidance.h"
#include "item3d/io/texture_format.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// The part of a scene that guidance changes.
enum class Optimize { texture, light, both };

/// Whether an edit may change metallic. automatic: only if a sentence names a metal.
enum class Metallic { automatic, always };

/// Whether the detail stage runs after the iterations. automatic: only if the target sentence has
/// one of `detail_words` that the source sentence lacks.
enum class Detail { automatic, off, always };

/// Kind of an optimised light. automatic: physical for priors of small images.
enum class LightChoice { automatic, physical, texels };

/// Variation of the light while a texture is edited. It keeps shading from being baked into the
/// texture (LightRig).
enum class LightAugment { off, rotate, all };

/// Whether written files state that they were edited (docs/provenance.md).
enum class SaysProvenance { on, off };

/// All settings that change the result, including additions to the prior (LoRA, ControlNet, ...).
/// settings_table.cpp documents each one and its range; JSON uses these names. Defaults are for
/// Stable Diffusion at 512 pixels.
struct EditSettings : PipelineExtras {
    std::string from;
    std::string to;
    std::string method = "item3d";  ///< one of edit_method_names()
    std::string guidance = "rdl";   ///< one of guidance_methods()
    Adjustment adjust = Adjustment::learned;
    int adjust_every = 25;
    float adjust_strength = 1;
    float adjust_learning_rate = 0.03f;
    int adjust_samples = 1;
    float settle = 0;
    float anchor = 0;
    float cfg = 7.5f;
    std::string negative_prompt;
    int steps = 0;
    int views = 0;
    ClipLoss clip_loss = ClipLoss::absolute;
    std::string instruction;
    float image_cfg = 1.5f;
    int iterations = 600;
    int iterations_before_detail = 0;
    int fit_steps = 200;
    int batch = 2;
    int resolution = 512;
    float learning_rate = 0.01f;
    float evenness = 0;
    std::vector<float> timesteps = {0.02f, 0.98f};
    TimestepSchedule timestep_schedule = TimestepSchedule::uniform;
    Weighting weighting = Weighting::dreamfusion;
    std::string light = "studio";
    Optimize optimize = Optimize::texture;
    LightChoice light_model = LightChoice::automatic;
    float light_learning_rate = 0.05f;
    std::vector<float> light_from;
    LightAugment light_augment = LightAugment::all;
    std::string background = "vary";
    int texture_size = 0;
    UvPolicy uv = UvPolicy::automatic;
    TextureFormat texture_format = TextureFormat::keep;
    std::vector<std::string> keep = {"occlusion", "normal"};
    Metallic metallic = Metallic::automatic;
    float metallic_start = 0.5f;
    Detail detail = Detail::automatic;
    std::vector<std::string> region;   ///< selectors (RegionRequest)
    std::vector<std::string> exclude;  ///< selectors
    float feather = 0;
    std::vector<std::string> detail_words;
    int detail_views = 20;
    std::vector<std::string> material;
    std::string variant;
    SaysProvenance provenance = SaysProvenance::on;
    std::uint64_t seed = 0;
};

void to_json(nlohmann::json& json, const EditSettings& settings);

/// Reads settings from JSON. Absent settings take their defaults. Throws InputError for an unknown
/// choice, and nlohmann::json::exception for a value of another type.
void from_json(const nlohmann::json& json, EditSettings& settings);

/// Throws InputError that names the first option whose value is out of range.
void check_settings(const EditSettings& settings);

/// Returns a value as text for people: 0.06 instead of all digits of the nearest float, lists
/// without brackets, and "none" for empty values.
std::string readable(const nlohmann::json& value);

/// Returns the content of docs/reference/settings.md: all settings as a table.
std::string settings_markdown();

}  // namespace item3d
