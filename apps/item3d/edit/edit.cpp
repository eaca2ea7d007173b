// item3d edit: a model and two sentences in, an edited model out.
#include "item3d/edit/edit.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/extras_options.h"
#include "apps/item3d/edit/relight_words.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/reconstructed_light.h"
#include "item3d/hub/find_prior.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/precision.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

struct EditCommandOptions : CommonOptions {
    EditRequest request;
    std::string from;
    std::string to;
    std::string prior;  ///< folder or name, see find_prior()
    /// Settings given on the command line; what is absent comes from the prior.
    nlohmann::json overrides = nlohmann::json::object();
};

/// An option that overrides one setting when it is given, and leaves it to the prior when not.
template <typename T>
CLI::Option* setting(CLI::App& command, EditCommandOptions& options, const std::string& flag,
                     const std::string& key, const std::string& help) {
    return command.add_option_function<T>(
        flag, [&options, key](const T& value) { options.overrides[key] = value; }, help);
}

void print_guidance_kinds() {
    fmt::print("{:6}{:76}{}\n", "method", "", "U-Net rows a picture");
    for (const GuidanceKind& kind : guidance_kinds())
        fmt::print("{:6}{:76}{}\n", kind.name, kind.description, kind.cost);
}

void add_settings(CLI::App& command, EditCommandOptions& options) {
    command
        .add_option_function<std::string>(
            "--guidance",
            [&options](const std::string& method) {
                if (method == "help") {
                    print_guidance_kinds();
                    throw CLI::Success();
                }
                options.overrides["guidance"] = method;
            },
            fmt::format("The method: {}; help tells what each is for and costs",
                        fmt::join(guidance_methods(), ", ")))
        ->trigger_on_parse();  // before it is said that the model is missing
    setting<std::string>(command, options, "--adjust", "adjust",
                         "How rdl's source follows the render: learned (by its denoising loss, the "
                         "default), caption (by what a captioner sees change), caption-paper (the "
                         "same with the sign of the paper's formula) or off");
    setting<int>(command, options, "--adjust-every", "adjust_every",
                 "Iterations between captions, and between the report's pictures of how it went");
    setting<float>(command, options, "--adjust-strength", "adjust_strength",
                   "How much captions count, 0 to 2");
    setting<float>(command, options, "--settle", "settle",
                   "Stop where the direction has shrunk to this part of its first length and stays "
                   "there; 0: do all iterations");
    setting<float>(command, options, "--anchor", "anchor",
                   "Pull towards the target's own score, added to rdl; 0: none, 1: strong");
    setting<float>(command, options, "--cfg", "cfg", "Weight of classifier-free guidance");
    setting<std::string>(command, options, "--negative-prompt", "negative_prompt",
                         "What not to show: guidance pushes away from it, and so does the detail "
                         "stage. Meaningless for rdl's direction, in which it cancels");
    setting<int>(command, options, "--iterations", "iterations",
                 "Steps of the optimisation; with --settle, at most. Without it, the prior's own "
                 "number, which may be smaller where the detail stage follows");
    setting<int>(command, options, "--batch", "batch", "Views in each step");
    setting<int>(command, options, "--resolution", "resolution",
                 "Edge in pixels of the pictures that the prior sees");
    setting<float>(command, options, "--learning-rate", "learning_rate", "Of the neural texture");
    setting<float>(
        command, options, "--evenness", "evenness",
        "How strongly an edit towards a plain colour or metal is held to change the same "
        "thing everywhere; 0: blotches stay");
    setting<std::vector<float>>(command, options, "--timesteps", "timesteps",
                                "MIN,MAX noise levels, as parts of the schedule (0.02,0.98)")
        ->delimiter(',')
        ->expected(2);
    setting<std::string>(command, options, "--timestep-schedule", "timestep_schedule",
                         "uniform (drawn, the default), anneal (from high to low) or dreamtime");
    setting<std::string>(command, options, "--weighting", "weighting",
                         "omega(t) of rdl, sds, nfsd and csd: early, late, dreamfusion or uniform");
    setting<std::string>(command, options, "--light", "light",
                         "studio, noon, sunset, overcast, night, or an .hdr or .exr file");
    setting<std::string>(command, options, "--optimize", "optimize",
                         "texture (the default), light (which relight does alone) or both");
    setting<std::string>(command, options, "--light-model", "light_model",
                         "Of a light that is optimised: physical, texels, or auto");
    setting<std::string>(command, options, "--light-augment", "light_augment",
                         "How the light varies while a texture is edited, so that no shading is "
                         "painted: off, rotate, or all (other presets and brightness too; the "
                         "default)");
    setting<std::string>(command, options, "--background", "background",
                         "A colour, or vary: another grey each step");
    setting<int>(command, options, "--texture-size", "texture_size",
                 "Edge of the textures that are written; 0: as the input's");
    setting<std::vector<std::string>>(
        command, options, "--keep", "keep",
        "Channels not to touch, instead of occlusion,normal: base_color, occlusion, roughness, "
        "metallic, normal; or nothing")
        ->delimiter(',');
    setting<std::string>(command, options, "--metallic", "metallic",
                         "auto: edit metallic where a sentence names a metal; always: in any case");
    setting<std::string>(
        command, options, "--detail", "detail",
        "Paint spots, courses or veins after the edit. auto: where the target names "
        "a pattern, or a material that the prior has them for; off; always");
    setting<std::vector<std::string>>(command, options, "--material", "material",
                                      "Edit only the materials of these names")
        ->delimiter(',');
    setting<std::uint64_t>(command, options, "--seed", "seed", "Another seed, another result");
}

void warn_of_words(const EditRequest& request, const EditSettings& settings) {
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    for (const std::string& prompt : {settings.from, settings.to}) {
        const std::string warning = vocabulary.warning(prompt, /*shape_is_given=*/true);
        if (!warning.empty()) warn(warning);
    }
}

/// What the options say of the light must be of use.
void refuse_contradictions(const EditCommandOptions& options) {
    const std::string optimize = options.overrides.value("optimize", "texture");
    const auto given = [&](const char* key) { return options.overrides.contains(key); };
    if (optimize != "texture" && given("light_augment"))
        throw UsageError("--light-augment varies a light that --optimize " + optimize +
                         " is to find: leave out one of them");
    if (optimize == "texture" && given("light_model"))
        throw UsageError("--light-model is that of --optimize light or both");
    if (optimize == "light" && (given("keep") || given("texture_size") || given("metallic")))
        throw UsageError(
            "--optimize light changes no texture: without --keep, --texture-size and --metallic");
}

void take_found_light(EditCommandOptions& options) {
    const auto light = reconstructed_light(options.request.model);
    if (light.empty() || options.overrides.contains("light")) return;
    if (suits_found_light(options.request.prior, options.overrides)) {
        note("light: " + light.string() + ", found with the model (--light takes another)");
        options.overrides["light"] = light.string();
    } else {
        note("light: the prior's own (--light " + light.string() +
             ": the one found with the model)");
    }
}

void run_edit(EditCommandOptions& options) {
    refuse_contradictions(options);

    EditRequest& request = options.request;
    request.device = start_command(options);
    request.prior = find_prior(options.prior);
    if (options.overrides.value("optimize", "") == "light")
        require_light_words(request.prior, options.to);
    if (request.clip.empty()) request.clip = find_in_prior(request.prior, "clip");
    if (request.captioner.empty()) request.captioner = find_in_prior(request.prior, "captioner");
    options.overrides["from"] = options.from;
    options.overrides["to"] = options.to;
    if (options.overrides.value("keep", nlohmann::json()) == nlohmann::json::array({"nothing"})) {
        options.overrides["keep"] = nlohmann::json::array();
    }
    take_found_light(options);
    request.settings = resolve_settings(request.prior, options.overrides);
    warn_of_words(request, request.settings);

    if (!request.settings.negative_prompt.empty() && request.settings.guidance == "rdl" &&
        !wants_detail(request.settings)) {
        warn(
            "--negative-prompt has no effect: it cancels in rdl's direction, and no detail stage "
            "follows");
    }

    if (options.overrides.value("adjust", "off") != "off" && request.settings.guidance != "rdl")
        warn("--adjust has no effect: only rdl has a source to adjust");

    const nlohmann::json summary = edit_model(request);
    if (options.json) {
        print_json(summary);
    } else {
        fmt::print("{}\n", (request.output / "report.html").string());
    }
}

}  // namespace

void add_edit_command(CLI::App& app) {
    auto options = std::make_shared<EditCommandOptions>();
    CLI::App* command = add_command(app, "edit", *options);
    EditRequest& request = options->request;
    command->add_option("MODEL", request.model, "A .glb, .gltf or .obj file")->required();
    command->add_option("--from", options->from, "What the model looks like now")->required();
    command->add_option("--to", options->to, "What it shall look like")->required();
    command->add_option("-o,--output", request.output, "Folder for everything that is made")
        ->required();
    command->add_option("--prior", options->prior,
                        "Diffusion model: a folder in the diffusers layout, or a name (item3d "
                        "prior pull); without it, the embedded one");
    command->add_option("--clip", request.clip,
                        "CLIP model in the transformers layout: scores of the result, as of score; "
                        "without it, the one that the prior brings along, if any");
    command->add_option("--captioner", request.captioner,
                        "BLIP or BLIP-2 in the transformers layout, for --adjust caption; without "
                        "it, the one that the prior brings along");
    command->add_flag("--resume", request.resume, "Go on from the checkpoint in the output folder");
    command->add_option("--precision", request.precision, "Of the networks")
        ->check(CLI::IsMember(precision_names()))
        ->capture_default_str();
    command
        ->add_option("--memory", request.memory,
                     "low takes less memory and more time; auto takes low where the usual does not "
                     "fit")
        ->check(CLI::IsMember({"auto", "low", "high"}))
        ->capture_default_str();
    add_settings(*command, *options);
    add_extras_options(*command, options->overrides);
    command->callback([options] {
        options->request.command = command_line();
        run_edit(*options);
    });
}

}  // namespace item3d
