#include "item3d/edit/settings_table.h"

#include "item3d/baselines/methods.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/lighting/environment.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

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
                          "Channels to leave unchanged: base_color, occlusion, roughness, "
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

/// Returns the rows of sentences, method and guidance.
std::vector<Setting> guidance_rows() {
    return {
        setting("from", &S::from, "--from",
                "Sentence that describes the model as it is: \"a red mug\""),
        setting("to", &S::to, "--to",
                "Sentence that describes the model as it should be: \"a golden mug\""),
        edit_method(),
        guidance_method(),
        choice<Adjustment>("adjust", &S::adjust, adjustment_names(), parse_adjustment, "--adjust",
                           "Adjustment of the source of rdl to the render: learned (by a denoising "
                           "loss), caption (by the change of a captioner's captions), "
                           "caption-paper (caption with the sign of the paper's formula), off"),
        setting("adjust_every", &S::adjust_every, between(1, 1000000, "1 or more"),
                "--adjust-every", "Iterations between captions, and between images in the report"),
        setting("adjust_strength", &S::adjust_strength, between(0, 2), "--adjust-strength",
                "Weight of the captions in --adjust caption"),
        setting("adjust_learning_rate", &S::adjust_learning_rate, above_zero(1), "",
                "Learning rate of the learned source"),
        setting("adjust_samples", &S::adjust_samples, between(1, 64), "",
                "Noise samples in each step of the learned source"),
        setting("settle", &S::settle,
                between(0, std::nextafter(1.0f, 0.0f), "between 0 (never) and 1"), "--settle",
                "Stop early when the length of the direction falls below this fraction of its "
                "initial length"),
        setting(
            "anchor", &S::anchor, between(0, 1000), "--anchor",
            "Weight of the target's score, which is added to the direction of rdl; 1 is strong"),
        setting("cfg", &S::cfg, between(-1000, 1000), "--cfg", "Scale of classifier-free guidance"),
        setting("negative_prompt", &S::negative_prompt, "--negative-prompt",
                "Negative prompt: what the result should not show. It affects the detail stage and "
                "every guidance but rdl, in which it cancels out"),
    };
}

/// Returns the rows of the optimisation and of the renders for the prior.
std::vector<Setting> optimization_rows() {
    return {
        setting("iterations", &S::iterations, at_least(0), "--iterations",
                "Optimisation steps. A prior may set another default, and a smaller one if the "
                "detail stage follows"),
        setting("iterations_before_detail", &S::iterations_before_detail, at_least(0), "",
                "Optimisation steps if the detail stage follows, which repaints the base colour; "
                "0: the same number as without it"),
        setting("fit_steps", &S::fit_steps, at_least(1), "",
                "Steps that fit the neural texture to the model's own materials"),
        setting("batch", &S::batch, between(1, 64), "--batch", "Views per step"),
        setting("resolution", &S::resolution, between(16, 2048, "between 16 and 2048 pixels"),
                "--resolution", "Edge length of the images that the prior sees, in pixels"),
        setting("learning_rate", &S::learning_rate, above_zero(1), "--learning-rate",
                "Learning rate of the neural texture"),
        setting("evenness", &S::evenness, between(0, 1e9, "between 0 (no regularization) and 1e9"),
                "--evenness",
                "Weight of a regularization that makes edits to a plain colour or metal even over "
                "the surface"),
        with_placeholder(
            "MIN,MAX",
            restricted(setting("timesteps", &S::timesteps, "--timesteps",
                               "Lowest and highest noise level, as fractions of the schedule"),
                       "two ascending numbers between 0 and 1, as in 0.02,0.98", are_timesteps)),
        choice<TimestepSchedule>(
            "timestep_schedule", &S::timestep_schedule, timestep_schedule_names(),
            parse_timestep_schedule, "--timestep-schedule",
            "Order of the noise levels: uniform (random), anneal (from high to low), dreamtime"),
        choice<Weighting>("weighting", &S::weighting, weighting_names(), parse_weighting,
                          "--weighting",
                          "Weighting of the noise levels, for rdl, sds, nfsd and csd: early, late, "
                          "dreamfusion, uniform"),
    };
}

/// Returns the rows of other methods' parameters.
std::vector<Setting> method_rows() {
    return {
        setting("steps", &S::steps, between(0, 999, "between 1 and 999, or 0 for the method's own"),
                "--steps", "Sampling steps, for a --method that samples"),
        setting("views", &S::views,
                between(0, 1000, "between 1 and 1000, or 0 for the method's own"), "--views",
                "Number of views that a --method paints or edits"),
        choice("clip_loss", &S::clip_loss, {"absolute", "directional"}, "--clip-loss",
               "Loss of --method clip: absolute (as in CLIP-NeRF's released code), directional"),
        setting("instruction", &S::instruction, "--instruction",
                "Instruction for --method in2n, such as \"turn it into gold\". Default: \"turn it "
                "into\" and --to"),
        setting("image_cfg", &S::image_cfg, between(0, 100), "--image-cfg",
                "Guidance scale of the unedited image, for --method in2n"),
    };
}

/// Returns the rows of the scene's light.
std::vector<Setting> light_rows() {
    return {
        with_placeholder("LIGHT", setting("light", &S::light, "--light",
                                          "Light around the model: " + light_presets_text() +
                                              ", or an .hdr or .exr file")),
        choice("optimize", &S::optimize, {"texture", "light", "both"}, "--optimize",
               "What the edit changes: texture, light (as `item3d relight --to` does), both"),
        choice("light_model", &S::light_model, {"auto", "physical", "texels"}, "--light-model",
               "Parameters of the light, if it is edited: physical (a sky, a sun and a ground), "
               "texels, auto"),
        setting("light_learning_rate", &S::light_learning_rate, above_zero(1), "",
                "Learning rate of the light, if it is edited"),
        restricted(setting("light_from", &S::light_from, "",
                           "Required direction of the light, if it is edited; empty: any"),
                   "an azimuth and an elevation in degrees", is_direction_or_none),
        choice("light_augment", &S::light_augment, {"off", "rotate", "all"}, "--light-augment",
               "Variation of the light during the edit, which keeps shading out of the textures: "
               "off, rotate, all (rotation, other presets and brightness)"),
        with_placeholder("COLOUR", setting("background", &S::background, "--background",
                                           "Background of the images that the prior sees: a "
                                           "colour, or vary (a random grey in each step)")),
    };
}

/// Returns the rows of the size, channels and detail of written textures.
std::vector<Setting> texture_rows() {
    return {
        setting("texture_size", &S::texture_size,
                between(0, 8192, "between 1 and 8192, or 0 for the input's own"), "--texture-size",
                "Edge length of the written textures, in pixels"),
        choice("uv", &S::uv, {"auto", "keep", "new"}, "--uv",
               "UV map: keep (the input's), new (one without overlaps), auto (new only for detail "
               "on untextured materials whose UVs overlap)"),
        choice("texture_format", &S::texture_format, {"keep", "png", "jpeg", "webp", "ktx2"},
               "--texture-format",
               "Format of the written textures: keep (that of each input texture), png, jpeg, "
               "webp, ktx2. Images with alpha are never written as JPEG, and kept channels are "
               "never compressed with loss"),
        kept_channels(),
        choice("metallic", &S::metallic, {"auto", "always"}, "--metallic",
               "When metallic is edited: auto (if a sentence names a metal), always"),
        setting(
            "metallic_start", &S::metallic_start, between(0, 1), "",
            "Initial value of metallic if only --to names a metal; 1 minus it if only --from does"),
        choice("detail", &S::detail, {"auto", "off", "always"}, "--detail",
               "Detail stage, which paints patterns such as spots, bricks or veins after the edit: "
               "auto (if --to names a pattern, or a material that the prior paints this way), off, "
               "always"),
        setting("detail_words", &S::detail_words, "",
                "Words in --to, in lower case, that start the detail stage if --from does not "
                "contain them"),
        setting("detail_views", &S::detail_views, between(1, 1000), "",
                "Number of views that the detail stage paints"),
        with_placeholder("NAME,...", setting("material", &S::material, "--material",
                                             "Edit only these materials, by name")),
        with_placeholder(
            "NAME",
            setting("variant", &S::variant, "--variant",
                    "Variant to edit, by name, of a glTF with several (KHR_materials_variants)")),
        choice("provenance", &S::provenance, {"on", "off"}, "--provenance",
               "on: record in the XMP of model and textures that a generative program edited them, "
               "with sentences, prior, input and date; off: do not"),
        setting("seed", &S::seed, "--seed", "Seed of all random numbers"),
    };
}

/// Returns the rows of the edited part of the surface.
std::vector<Setting> region_rows() {
    return {
        with_placeholder(
            "SELECTOR",
            repeated(setting("region", &S::region, "--region",
                             "Part of the surface to edit, as a selector (`item3d region --help`); "
                             "several selectors are united. auto: where the prior sees a "
                             "difference between the sentences; all: everything. Default: the old "
                             "colour if the edit changes one colour to another, else everything"))),
        with_placeholder(
            "SELECTOR", repeated(setting("exclude", &S::exclude, "--exclude",
                                         "Part of the surface to leave unchanged, as a selector"))),
        setting("feather", &S::feather, between(0, 50), "--feather",
                "Width of the soft border inside the region, in percent of the model's size"),
    };
}

/// Returns the rows of the additions to the prior.
std::vector<Setting> extras_rows() {
    return {
        with_placeholder(
            "FILE",
            repeated(setting("lora", &S::lora, "--lora",
                             "LoRA (.safetensors) added to the prior: FILE or FILE:SCALE"))),
        with_placeholder("FILE[:TOKEN]",
                         repeated(setting("embedding", &S::embedding, "--embedding",
                                          "Textual inversion (.safetensors), used by its token in "
                                          "a prompt: FILE or FILE:TOKEN"))),
        with_placeholder(
            "FOLDER",
            setting("controlnet", &S::controlnet, "--controlnet",
                    "Folder of a depth ControlNet, for a prior that does not take depth")),
        setting("controlnet_scale", &S::controlnet_scale, between(0, max_controlnet_scale),
                "--controlnet-scale", "Weight of the ControlNet"),
        with_placeholder(
            "FOLDER",
            setting("vae", &S::vae, "--vae",
                    "Folder of another autoencoder, for example a tiny one for faster gradients")),
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
    ITEM3D_CHECK(false, "unknown setting " + name);
}

}  // namespace item3d
