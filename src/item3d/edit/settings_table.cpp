#include "item3d/edit/settings_table.h"

#include "item3d/baselines/methods.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

using S = EditSettings;
using rows::above_zero, rows::at_least, rows::between, rows::choice, rows::repeated;
using rows::restricted, rows::setting, rows::with_placeholder;

bool are_timesteps(const S& settings) {
    const std::vector<float>& t = settings.timesteps;
    return t.size() == 2 && t[0] >= 0 && t[0] < t[1] && t[1] <= 1;
}

bool is_direction_or_none(const S& settings) {
    return settings.light_from.empty() || settings.light_from.size() == 2;
}

Setting kept_channels() {
    Setting row = setting("keep", &S::keep, "--keep",
                          "Channels that stay as they are: base_color, occlusion, roughness, "
                          "metallic, normal; or nothing");
    row.placeholder = "CHANNEL,...";
    row.check = [](const S& settings) {
        constexpr std::array channels = {"base_color", "occlusion", "roughness", "metallic",
                                         "normal"};
        for (const std::string& channel : settings.keep)
            if (std::find(channels.begin(), channels.end(), channel) == channels.end())
                throw InputError("--keep", fmt::format("'{}' is not a channel; choose from {}",
                                                       channel, fmt::join(channels, ", ")));
    };
    return row;
}

Setting edit_method() {
    Setting row = setting("method", &S::method, "--method",
                          fmt::format("Method: {}; `--method help` explains them",
                                      fmt::join(edit_method_names(), ", ")));
    row.check = [](const S& settings) {
        rows::find_choice("--method", edit_method_names(), settings.method);
    };
    row.choices = edit_method_names();
    return row;
}

Setting guidance_method() {
    Setting row = setting("guidance", &S::guidance, "--guidance",
                          fmt::format("Guidance: {}; `--guidance help` explains them",
                                      fmt::join(guidance_methods(), ", ")));
    row.choices = guidance_methods();
    return row;
}

/// Sentences, method and guidance.
std::vector<Setting> guidance_rows() {
    return {
        setting("from", &S::from, "--from", "The model as it is: \"a red mug\""),
        setting("to", &S::to, "--to", "The model as it should be: \"a golden mug\""),
        edit_method(),
        guidance_method(),
        choice<Adjustment>("adjust", &S::adjust, adjustment_names(), parse_adjustment, "--adjust",
                           "How the source of rdl follows the render: learned (by a denoising "
                           "loss), caption (by the change that a captioner sees), caption-paper "
                           "(caption with the sign of the paper's formula), off"),
        setting("adjust_every", &S::adjust_every, between(1, 1000000, "1 or more"),
                "--adjust-every",
                "Iterations between captions, and between pictures of the report"),
        setting("adjust_strength", &S::adjust_strength, between(0, 2), "--adjust-strength",
                "Weight of the captions"),
        setting("adjust_learning_rate", &S::adjust_learning_rate, "",
                "Learning rate of the learned source"),
        setting("adjust_samples", &S::adjust_samples, between(1, 64), "",
                "Noise samples in each step of the learned source"),
        setting("settle", &S::settle,
                between(0, std::nextafter(1.0f, 0.0f), "between 0 (never) and 1"), "--settle",
                "Stop early: once the direction has shrunk to this part of its first length"),
        setting("anchor", &S::anchor, "--anchor",
                "Weight of a pull towards the score of the target, added to rdl; 1 is strong"),
        setting("cfg", &S::cfg, "--cfg", "Scale of classifier-free guidance"),
        setting("negative_prompt", &S::negative_prompt, "--negative-prompt",
                "Prompt to stay away from. It acts on every guidance but rdl, where it cancels, "
                "and on the detail stage"),
    };
}

/// Optimisation, and the renders for the prior.
std::vector<Setting> optimization_rows() {
    return {
        setting("iterations", &S::iterations, at_least(0), "--iterations",
                "Optimisation steps. Without it: the number of the prior, which may be smaller "
                "where the detail stage follows"),
        setting("iterations_before_detail", &S::iterations_before_detail, at_least(0), "",
                "Optimisation steps where the detail stage follows, which paints the base colour "
                "anew; 0: as many as without it"),
        setting("fit_steps", &S::fit_steps, at_least(1), "",
                "Steps that fit the neural texture to the model's own materials"),
        setting("batch", &S::batch, between(1, 64), "--batch", "Views in each step"),
        setting("resolution", &S::resolution, between(16, 2048, "between 16 and 2048 pixels"),
                "--resolution", "Edge of the pictures that the prior sees"),
        setting("learning_rate", &S::learning_rate, above_zero(), "--learning-rate",
                "Learning rate of the neural texture"),
        setting("evenness", &S::evenness, between(0, 1e9, "between 0 (blotches stay) and 1e9"),
                "--evenness",
                "How evenly an edit to a plain colour or metal spreads over the surface"),
        with_placeholder(
            "MIN,MAX",
            restricted(setting("timesteps", &S::timesteps, "--timesteps",
                               "Lowest and highest noise level, as parts of the schedule"),
                       "two rising numbers between 0 and 1, as in 0.02,0.98", are_timesteps)),
        choice<TimestepSchedule>("timestep_schedule", &S::timestep_schedule,
                                 timestep_schedule_names(), parse_timestep_schedule,
                                 "--timestep-schedule",
                                 "Order of the noise levels: uniform (drawn at random), anneal "
                                 "(from high to low), dreamtime"),
        choice<Weighting>("weighting", &S::weighting, weighting_names(), parse_weighting,
                          "--weighting",
                          "Weight of a noise level, for rdl, sds, nfsd and csd: early, late, "
                          "dreamfusion, uniform"),
    };
}

/// Parameters of other methods.
std::vector<Setting> method_rows() {
    return {
        setting("steps", &S::steps, between(0, 999, "between 1 and 999, or 0 for the method's own"),
                "--steps", "Sampling steps of a --method that samples"),
        setting("views", &S::views,
                between(0, 1000, "between 1 and 1000, or 0 for the method's own"), "--views",
                "Views that a --method paints or edits"),
        choice("clip_loss", &S::clip_loss, {"absolute", "directional"}, "--clip-loss",
               "Loss of --method clip: absolute (as in CLIP-NeRF's released code), directional"),
        setting("instruction", &S::instruction, "--instruction",
                "Instruction of --method in2n: \"turn it into gold\". Without it: \"turn it into\" "
                "and --to"),
        setting("image_cfg", &S::image_cfg, between(0, 100), "--image-cfg",
                "Guidance scale of the unedited view, for --method in2n"),
    };
}

/// Light of the scene.
std::vector<Setting> light_rows() {
    return {
        with_placeholder(
            "LIGHT",
            setting(
                "light", &S::light, "--light",
                "Light around the model: studio, noon, sunset, overcast, night, or an .hdr or .exr "
                "file")),
        choice("optimize", &S::optimize, {"texture", "light", "both"}, "--optimize",
               "What the edit changes: texture, light (as `item3d relight --to` does), both"),
        choice("light_model", &S::light_model, {"auto", "physical", "texels"}, "--light-model",
               "Parameters of a light that is edited: physical (a sky, a sun and a ground), "
               "texels, auto"),
        setting("light_learning_rate", &S::light_learning_rate, above_zero(), "",
                "Learning rate of a light that is edited"),
        restricted(setting("light_from", &S::light_from, "",
                           "Direction that a light that is edited must come from; empty: any"),
                   "an azimuth and an elevation in degrees", is_direction_or_none),
        choice("light_augment", &S::light_augment, {"off", "rotate", "all"}, "--light-augment",
               "Variation of the light while textures are edited, which keeps shading out of them: "
               "off, rotate, all (rotation, other presets and brightness)"),
        with_placeholder(
            "COLOUR",
            setting(
                "background", &S::background, "--background",
                "Background of the pictures that the prior sees: a colour, or vary (another grey "
                "in each step)")),
    };
}

/// Size, channels and detail of written textures.
std::vector<Setting> texture_rows() {
    return {
        setting("texture_size", &S::texture_size,
                between(0, 8192, "between 1 and 8192, or 0 for the input's own"), "--texture-size",
                "Edge of the written textures, in pixels"),
        choice("uv", &S::uv, {"auto", "keep", "new"}, "--uv",
               "UV map: keep (the input's), new (one without overlaps), auto (new only for detail "
               "on untextured materials whose UVs overlap)"),
        choice("texture_format", &S::texture_format, {"keep", "png", "jpeg", "webp", "ktx2"},
               "--texture-format",
               "Format of the written textures: keep (that of each input texture), png, jpeg, "
               "webp, ktx2. Images with alpha are never JPEG, and a kept channel is never "
               "compressed with loss"),
        kept_channels(),
        choice("metallic", &S::metallic, {"auto", "always"}, "--metallic",
               "When metallic is edited: auto (where a sentence names a metal), always"),
        setting("metallic_start", &S::metallic_start, between(0, 1), "",
                "First value of metallic where only --to names a metal; 1 minus it where only "
                "--from does"),
        choice("detail", &S::detail, {"auto", "off", "always"}, "--detail",
               "Detail stage, which paints spots, courses or veins after the edit: auto (where "
               "--to names a pattern, or a material that the prior paints so), off, always"),
        setting(
            "detail_words", &S::detail_words, "",
            "Words of --to, in lower case, that start the detail stage where --from lacks them"),
        setting("detail_views", &S::detail_views, between(1, 1000), "",
                "Views that the detail stage paints"),
        with_placeholder("NAME,...", setting("material", &S::material, "--material",
                                             "Edit only these materials, by name")),
        with_placeholder(
            "NAME",
            setting("variant", &S::variant, "--variant",
                    "Look to edit, by name, of a glTF that has several (KHR_materials_variants)")),
        choice("provenance", &S::provenance, {"on", "off"}, "--provenance",
               "on: model and textures say in XMP that a generative program edited them, with "
               "sentences, prior, input and date. off: they do not"),
        setting("seed", &S::seed, "--seed",
                "Seed of everything random; another seed gives another result"),
    };
}

/// Edited part of the surface.
std::vector<Setting> region_rows() {
    return {
        with_placeholder(
            "SELECTOR",
            repeated(setting(
                "region", &S::region, "--region",
                "Part of the surface to edit, by a selector (`item3d region --help`); several: "
                "their union. auto: where the sentences differ to the prior; all: everything. "
                "Without it: the first colour of a change of colours, else everything"))),
        with_placeholder("SELECTOR", repeated(setting("exclude", &S::exclude, "--exclude",
                                                      "Part to leave alone, by a selector"))),
        setting("feather", &S::feather, between(0, 50), "--feather",
                "Width of the soft border inside the region, in percent of the model's size"),
    };
}

/// Additions to the prior.
std::vector<Setting> extras_rows() {
    return {
        with_placeholder(
            "FILE",
            repeated(setting("lora", &S::lora, "--lora",
                             "LoRA (.safetensors) added to the prior: FILE or FILE:SCALE"))),
        with_placeholder("FILE[:TOKEN]",
                         repeated(setting("embedding", &S::embedding, "--embedding",
                                          "Textual inversion (.safetensors), which a prompt "
                                          "names by its token: FILE or FILE:TOKEN"))),
        with_placeholder(
            "FOLDER",
            setting("controlnet", &S::controlnet, "--controlnet",
                    "Folder of a depth ControlNet, for a prior that takes no depth itself")),
        setting("controlnet_scale", &S::controlnet_scale, "--controlnet-scale",
                "Weight of the ControlNet"),
        with_placeholder(
            "FOLDER",
            setting("vae", &S::vae, "--vae",
                    "Folder of another autoencoder, such as a tiny one for faster gradients")),
    };
}

}  // namespace

const std::vector<Setting>& settings_table() {
    static const std::vector<Setting> table = [] {
        std::vector<Setting> all;
        const auto add = [&all](const char* group, std::vector<Setting> rows) {
            for (Setting& row : rows) {
                row.group = group;
                all.push_back(std::move(row));
            }
        };
        add("Guidance", guidance_rows());
        add("Optimisation", optimization_rows());
        add("Methods", method_rows());
        add("Light", light_rows());
        add("Textures", texture_rows());
        add("Region", region_rows());
        add("Prior", extras_rows());
        return all;
    }();
    return table;
}

const Setting& setting_named(const std::string& name) {
    for (const Setting& row : settings_table())
        if (row.name == name) return row;
    ITEM3D_CHECK(false, "there is no setting " + name);
}

}  // namespace item3d
