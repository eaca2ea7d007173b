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
using rows::restricted, rows::setting;

bool are_timesteps(const S& settings) {
    const std::vector<float>& t = settings.timesteps;
    return t.size() == 2 && t[0] >= 0 && t[0] < t[1] && t[1] <= 1;
}

bool is_direction_or_none(const S& settings) {
    return settings.light_from.empty() || settings.light_from.size() == 2;
}

Setting kept_channels() {
    Setting row = setting("keep", &S::keep, "--keep",
                          "Channels not to touch, instead of occlusion,normal: base_color, "
                          "occlusion, roughness, metallic, normal; or nothing");
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
                          fmt::format("Of the edit: {}; help tells what each is and costs",
                                      fmt::join(edit_method_names(), ", ")));
    row.check = [](const S& settings) {
        rows::find_choice("--method", edit_method_names(), settings.method);
    };
    row.choices = edit_method_names();
    return row;
}

Setting guidance_method() {
    Setting row = setting("guidance", &S::guidance, "--guidance",
                          fmt::format("The method: {}; help tells what each is for and costs",
                                      fmt::join(guidance_methods(), ", ")));
    row.choices = guidance_methods();
    return row;
}

/// The sentences, and what guides an edit from the one to the other.
std::vector<Setting> guidance_rows() {
    return {
        setting("from", &S::from, "--from", "What the model looks like now"),
        setting("to", &S::to, "--to", "What it shall look like"),
        edit_method(),
        guidance_method(),
        choice<Adjustment>(
            "adjust", &S::adjust, adjustment_names(), parse_adjustment, "--adjust",
            "How rdl's source follows the render: learned (by its denoising loss, the default), "
            "caption (by what a captioner sees change), caption-paper (the same with the sign of "
            "the paper's formula) or off"),
        setting("adjust_every", &S::adjust_every, between(1, 1000000, "1 or more iterations"),
                "--adjust-every",
                "Iterations between captions, and between the report's pictures of how it went"),
        setting("adjust_strength", &S::adjust_strength, between(0, 2), "--adjust-strength",
                "How much captions count, 0 to 2"),
        setting("adjust_learning_rate", &S::adjust_learning_rate, "", "Of the learned source"),
        setting("adjust_samples", &S::adjust_samples, between(1, 64), "",
                "Noises that each step of the learned source looks at"),
        setting("settle", &S::settle,
                between(0, std::nextafter(1.0f, 0.0f), "between 0 (never) and 1"), "--settle",
                "Stop where the direction has shrunk to this part of its first length and stays "
                "there; 0: do all iterations"),
        setting("anchor", &S::anchor, "--anchor",
                "Pull towards the target's own score, added to rdl; 0: none, 1: strong"),
        setting("cfg", &S::cfg, "--cfg", "Weight of classifier-free guidance"),
        setting("negative_prompt", &S::negative_prompt, "--negative-prompt",
                "What not to show: guidance pushes away from it, and so does the detail stage. "
                "Meaningless for rdl's direction, in which it cancels"),
    };
}

/// The optimisation, and what the prior sees of it.
std::vector<Setting> optimization_rows() {
    return {
        setting("iterations", &S::iterations, at_least(0), "--iterations",
                "Steps of the optimisation; with --settle, at most. Without it, the prior's own "
                "number, which may be smaller where the detail stage follows"),
        setting("iterations_before_detail", &S::iterations_before_detail, at_least(0), "",
                "Iterations where a texture is edited and the detail stage follows, which paints "
                "anew what they made of the base colour; 0: as many as without it"),
        setting("fit_steps", &S::fit_steps, at_least(1), "",
                "Steps that make the neural texture look like the model's own materials"),
        setting("batch", &S::batch, between(1, 64), "--batch", "Views in each step"),
        setting("resolution", &S::resolution, between(16, 2048, "between 16 and 2048 pixels"),
                "--resolution", "Edge in pixels of the pictures that the prior sees"),
        setting("learning_rate", &S::learning_rate, above_zero(), "--learning-rate",
                "Of the neural texture"),
        setting("evenness", &S::evenness, between(0, 1e9, "between 0 (blotches stay) and 1e9"),
                "--evenness",
                "How strongly an edit towards a plain colour or metal is held to change the same "
                "thing everywhere; 0: blotches stay"),
        restricted(setting("timesteps", &S::timesteps, "--timesteps",
                           "MIN,MAX noise levels, as parts of the schedule (0.02,0.98)"),
                   "two rising numbers between 0 and 1, as in 0.02,0.98", are_timesteps),
        choice<TimestepSchedule>(
            "timestep_schedule", &S::timestep_schedule, timestep_schedule_names(),
            parse_timestep_schedule, "--timestep-schedule",
            "uniform (drawn, the default), anneal (from high to low) or dreamtime"),
        choice<Weighting>(
            "weighting", &S::weighting, weighting_names(), parse_weighting, "--weighting",
            "omega(t) of rdl, sds, nfsd and csd: early, late, dreamfusion or uniform"),
    };
}

/// What methods other than this project's own take.
std::vector<Setting> method_rows() {
    return {
        setting("steps", &S::steps, between(0, 999, "between 1 and 999, or 0 for the method's own"),
                "--steps", "Steps of sampling, of a --method that samples; 0: as it was published"),
        setting("views", &S::views,
                between(0, 1000, "between 1 and 1000, or 0 for the method's own"), "--views",
                "Views that a --method paints or edits; 0: as many as were published"),
        choice("clip_loss", &S::clip_loss, {"absolute", "directional"}, "--clip-loss",
               "Of --method clip: absolute (as CLIP-NeRF's released code) or directional"),
        setting("instruction", &S::instruction, "--instruction",
                "Of --method in2n: what to do, in words (\"turn it into gold\"); without it, "
                "\"turn it into\" and --to"),
        setting("image_cfg", &S::image_cfg, between(0, 100), "--image-cfg",
                "Of --method in2n: how much the unedited view counts"),
    };
}

/// The light that the model stands in.
std::vector<Setting> light_rows() {
    return {
        setting("light", &S::light, "--light",
                "studio, noon, sunset, overcast, night, or an .hdr or .exr file"),
        choice("optimize", &S::optimize, {"texture", "light", "both"}, "--optimize",
               "texture (the default), light (which relight does alone) or both"),
        choice("light_model", &S::light_model, {"auto", "physical", "texels"}, "--light-model",
               "Of a light that is optimised: physical, texels, or auto"),
        setting("light_learning_rate", &S::light_learning_rate, above_zero(), "",
                "Of a light that is optimised"),
        restricted(setting("light_from", &S::light_from, "",
                           "Where a light that is optimised must come from; empty: from anywhere"),
                   "an azimuth and an elevation in degrees", is_direction_or_none),
        choice("light_augment", &S::light_augment, {"off", "rotate", "all"}, "--light-augment",
               "How the light varies while a texture is edited, so that no shading is painted: "
               "off, rotate, or all (other presets and brightness too; the default)"),
        setting("background", &S::background, "--background",
                "A colour, or vary: another grey each step"),
    };
}

/// Textures that are written: size, channels, detail.
std::vector<Setting> texture_rows() {
    return {
        setting("texture_size", &S::texture_size,
                between(0, 8192, "between 1 and 8192, or 0 for the input's own"), "--texture-size",
                "Edge of the textures that are written; 0: as the input's"),
        choice("uv", &S::uv, {"auto", "keep", "new"}, "--uv",
               "The UV map: auto (the input's own, but for detail on a material without textures "
               "whose "
               "UVs overlap), keep, or new (each place gets texels of its own)"),
        choice("texture_format", &S::texture_format, {"keep", "png", "jpeg", "webp", "ktx2"},
               "--texture-format",
               "Of the textures that are written: keep (each as the input's, the default), png, "
               "jpeg, webp or ktx2; images with alpha are never JPEG, and those of which a channel "
               "must "
               "not change are written without losses"),
        kept_channels(),
        choice("metallic", &S::metallic, {"auto", "always"}, "--metallic",
               "auto: edit metallic where a sentence names a metal; always: in any case"),
        setting("metallic_start", &S::metallic_start, between(0, 1), "",
                "Where metallic begins if the target names a metal and the source does not; as far "
                "from 1 where only the source does"),
        choice("detail", &S::detail, {"auto", "off", "always"}, "--detail",
               "Paint spots, courses or veins after the edit. auto: where the target names a "
               "pattern, or a material that the prior has them for; off; always"),
        setting(
            "detail_words", &S::detail_words, "",
            "Words in lower case, of which the target must have one that the source has not for "
            "the detail stage to run by itself"),
        setting("detail_views", &S::detail_views, between(1, 1000), "",
                "Views that the detail stage paints"),
        setting("material", &S::material, "--material", "Edit only the materials of these names"),
        setting("variant", &S::variant, "--variant",
                "Edit and show the look of this name, of a glTF that offers several "
                "(KHR_materials_variants)"),
        choice("provenance", &S::provenance, {"on", "off"}, "--provenance",
               "on (the default): model and textures say, as XMP, that a generative program edited "
               "them, with sentences, prior, input and date; off: nothing"),
        setting("seed", &S::seed, "--seed", "Another seed, another result"),
    };
}

/// The part of the surface that is edited.
std::vector<Setting> region_rows() {
    return {
        repeated(setting("region", &S::region, "--region",
                         "Edit only what this selector takes (item3d region --help lists them); "
                         "may be given several times, for their union. auto: where the "
                         "sentences differ to the prior; all: everything. Without it: of a change "
                         "from one colour to another, what has the first; else everything")),
        repeated(setting("exclude", &S::exclude, "--exclude",
                         "Leave alone what this selector takes; may be given several times")),
        setting("feather", &S::feather, between(0, 50), "--feather",
                "Width of a region's soft border, within it, in percent of the model's size"),
    };
}

/// Additions to the prior.
std::vector<Setting> extras_rows() {
    return {
        repeated(setting("lora", &S::lora, "--lora",
                         "FILE or FILE:SCALE: a LoRA (.safetensors) added to the prior's weights; "
                         "may be given several times")),
        repeated(setting("embedding", &S::embedding, "--embedding",
                         "FILE or FILE:TOKEN: a textual inversion (.safetensors), which a prompt "
                         "then names by its token; may be given several times")),
        setting("controlnet", &S::controlnet, "--controlnet",
                "Folder of a depth ControlNet, for a prior that takes no depth itself"),
        setting("controlnet_scale", &S::controlnet_scale, "--controlnet-scale",
                "How much the ControlNet counts, 1 if not given"),
        setting("vae", &S::vae, "--vae",
                "Folder of another autoencoder for the prior, as a tiny one for a faster gradient"),
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
