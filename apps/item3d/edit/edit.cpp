// Command item3d edit: edits a model from two sentences.
#include "apps/item3d/edit/edit.h"

#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/model_options.h"
#include "apps/item3d/edit/plan_file.h"
#include "apps/item3d/edit/relight_words.h"
#include "apps/item3d/edit/setting_options.h"
#include "item3d/baselines/methods.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/edit.h"
#include "item3d/edit/reconstructed_light.h"
#include "item3d/edit/sequence/region_check.h"
#include "item3d/edit/sequence/sequence.h"
#include "item3d/edit/settings_table.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/precision.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

void print_guidance_kinds() {
    fmt::print("{:6}{:76}{}\n", "method", "", "U-Net rows per image");
    for (const GuidanceKind& kind : guidance_kinds())
        fmt::print("{:6}{:76}{}\n", kind.name, kind.description, kind.cost);
}

void print_methods() {
    fmt::print("{:14}{:76}{}\n", "method", "", "U-Net rows");
    for (const EditMethod& method : edit_methods())
        fmt::print("{:14}{:76}{}\n", method.name, method.description, method.cost);
}

/// Adds a setting whose value "help" is handled before the check for a missing model.
void add_with_help(CLI::App& command, nlohmann::json& overrides, const char* setting,
                   void (*print)()) {
    add_setting(command, overrides, setting)
        ->each([print](const std::string& value) {
            if (value != "help") return;
            print();
            throw CLI::Success();
        })
        ->trigger_on_parse();
}

void warn_of_words(const EditRequest& request) {
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    std::string before;  // the warning for the first sentence, which is not repeated
    for (const std::string& prompt : {request.plan.from, request.plan.to}) {
        const std::string warning = vocabulary.warning(prompt, /*shape_is_given=*/true);
        if (!warning.empty() && warning != before) warn(warning);
        before = warning;
    }
}

/// Throws UsageError for options that contradict --optimize.
void refuse_contradictions(const nlohmann::json& overrides) {
    const auto optimize = overrides.get<EditSettings>().optimize;
    const auto given = [&](const char* key) { return overrides.contains(key); };
    const std::string method = overrides.value("method", "item3d");
    if (method != "item3d" && given("guidance"))
        throw UsageError("--guidance is only used by --method item3d; leave out one of them");
    if (method != "item3d" && optimize != Optimize::texture)
        throw UsageError("--method " + method + " only edits textures; leave out --optimize");
    for (const auto& [key, owner] :
         {std::pair("clip_loss", "clip"), {"instruction", "in2n"}, {"image_cfg", "in2n"}})
        if (method != owner && given(key))
            throw UsageError(
                fmt::format("{} is only used by --method {}", setting_named(key).flag, owner));
    if (optimize != Optimize::texture && given("light_augment"))
        throw UsageError("--light-augment varies the light that --optimize " +
                         overrides["optimize"].get<std::string>() +
                         " optimizes; leave out one of them");
    if (optimize == Optimize::texture && given("light_model"))
        throw UsageError("--light-model requires --optimize light or both");
    if (optimize == Optimize::light &&
        (given("keep") || given("texture_size") || given("texture_format") || given("metallic")))
        throw UsageError(
            "--optimize light changes no texture; leave out --keep, --texture-size, "
            "--texture-format and --metallic");
}

void take_found_light(EditCommandOptions& options) {
    const auto light = reconstructed_light(options.request.model);
    if (light.empty() || options.overrides.contains("light")) return;
    if (suits_found_light(options.request.prior, options.overrides)) {
        note("light: " + light.string() +
             ", which was reconstructed with the model (--light sets another)");
        options.overrides["light"] = light.string();
    } else {
        note("light: the prior's default (use --light " + light.string() +
             " for the light that was reconstructed with the model)");
    }
}

/// Warns of options without effect under these settings.
void warn_of_options(const EditPlan& plan, const nlohmann::json& overrides) {
    if (!plan.negative_prompt.empty() && plan.guidance == "rdl" && !plan.paints_detail) {
        warn(
            "--negative-prompt has no effect: it cancels out in the direction of rdl, and no "
            "detail stage follows");
    }
    if (plan.from == plan.to) warn("--from and --to are the same: nothing will change");
    if (overrides.contains("adjust") && plan.adjust != Adjustment::off && plan.guidance != "rdl")
        warn("--adjust has no effect: only --guidance rdl has a source to adjust");
}

/// Returns the given settings. The value "nothing" of the kept channels becomes an empty list.
nlohmann::json given_settings(const EditCommandOptions& options) {
    nlohmann::json overrides = options.overrides;
    if (overrides.get<EditSettings>().keep == std::vector<std::string>{"nothing"})
        overrides["keep"] = nlohmann::json::array();
    return overrides;
}

/// Makes the plan of the request. Warns of options without effect.
void plan_request(EditCommandOptions& options) {
    EditRequest& request = options.request;
    nlohmann::json& overrides = options.overrides;
    const auto said = overrides.get<EditSettings>();
    if (said.optimize == Optimize::light) require_light_words(request.prior, said.to);
    take_found_light(options);
    request.plan = resolve_plan(request.prior, given_settings(options));
    warn_of_words(request);
    warn_of_options(request.plan, overrides);
}

nlohmann::json edit_by_plan(const EditCommandOptions& options) {
    EditSequence sequence;
    sequence.plan = options.plan_file.string();
    sequence.model = options.request.model;
    sequence.output = options.request.output;
    sequence.resume = options.request.resume;
    for (const nlohmann::json& settings : read_plan_file(options.plan_file)) {
        // A command-line option applies to all edits that do not set it themselves.
        EditCommandOptions one = options;
        one.overrides.update(settings);
        try {
            refuse_contradictions(one.overrides);
            plan_request(one);
        } catch (const Error& error) {
            throw InputError(edit_name(sequence.plan, sequence.edits.size()), error.what());
        }
        sequence.edits.push_back(one.request);
    }
    return edit_in_sequence(sequence);
}

nlohmann::json edit_once(EditCommandOptions& options, EditSession& session) {
    plan_request(options);
    return edit_model(options.request, session);
}

void run_edit(EditCommandOptions& options) {
    EditSession session;
    const nlohmann::json summary = perform_edit(options, session);
    if (!options.request.processes.first()) return;
    if (options.json) {
        print_json(summary);
    } else {
        fmt::print("{}\n", (options.request.output / "report.html").string());
    }
}

}  // namespace

void check_edit_options(const EditCommandOptions& options) {
    const EditRequest& request = options.request;
    if (is_file_name(lower_extension(request.output)))
        throw UsageError(
            "-o " + request.output.string() +
            ": expected a folder for model.glb and the report, found the name of a file");
    if (options.plan_file.empty() &&
        !(options.overrides.contains("from") && options.overrides.contains("to")))
        throw UsageError("--from and --to, or --plan, are required");
    if (!options.plan_file.empty() &&
        (options.overrides.contains("from") || options.overrides.contains("to")))
        throw UsageError("--plan contains the sentences of its edits; leave out --from and --to");
    if (!options.sign_key.path.empty() && options.overrides.value("provenance", "on") == "off")
        throw UsageError(
            "--sign-key cannot be used with --provenance off, which writes nothing to sign");
    if (options.plan_file.empty()) refuse_contradictions(options.overrides);
    check_settings(given_settings(options).get<EditSettings>());
}

nlohmann::json perform_edit(EditCommandOptions& options, EditSession& session) {
    check_edit_options(options);
    EditRequest& request = options.request;
    request.sign_key = options.sign_key.load();
    request.device = start_command(options);
    if (!request.live.empty()) make_output_folder(request.live);
    request.processes = ProcessGroup::from_environment();
    if (request.processes.several() && !options.plan_file.empty())
        throw UsageError("--plan runs in one process; unset RANK and WORLD_SIZE");
    // Only the first process prints messages.
    if (!request.processes.first()) set_verbosity(Verbosity::quiet);
    request.prior = find_prior(options.prior);
    if (request.clip.empty()) request.clip = find_in_prior(request.prior, "clip");
    if (request.captioner.empty()) request.captioner = find_in_prior(request.prior, "captioner");
    if (request.segmenter.empty()) request.segmenter = find_in_prior(request.prior, "segmenter");
    if (request.instruct.empty()) request.instruct = find_in_prior(request.prior, "instruct");
    return options.plan_file.empty() ? edit_once(options, session) : edit_by_plan(options);
}

namespace {

/// Adds the options for networks other than the prior's U-Net.
void add_network_options(CLI::App& command, EditRequest& request) {
    const auto add = [&command](const char* name, std::filesystem::path& folder, const char* help) {
        command.add_option(name, folder, help)->type_name("FOLDER")->group("Networks");
    };
    add("--clip", request.clip,
        "CLIP model in the transformers layout, for the scores. Default: the prior's own, if it "
        "has one");
    add("--captioner", request.captioner,
        "BLIP or BLIP-2 in the transformers layout, for --adjust caption. Default: the prior's "
        "own");
    add("--segmenter", request.segmenter,
        "CLIPSeg in the transformers layout, for --region words=. Default: the prior's own, else "
        "its cross-attention");
    add("--inpainting", request.inpainting,
        "Inpainting prior (9 input channels), for --method texture. Default: the latents of "
        "--prior are blended");
    add("--instruct", request.instruct,
        "InstructPix2Pix in the diffusers layout, for --method in2n. Default: the prior's own");
    add("--teacher", request.teacher,
        "CLIP model that guides --method clip. Default: that of --clip");
    command.add_option("--precision", request.precision, "Precision of the networks")
        ->check(CLI::IsMember(precision_names()))
        ->capture_default_str()
        ->group("Networks");
    command
        .add_option("--memory", request.memory,
                    "Memory use: low needs less memory and more time, auto chooses low if high "
                    "does not fit")
        ->check(CLI::IsMember({"auto", "low", "high"}))
        ->capture_default_str()
        ->group("Networks");
}

}  // namespace

void add_edit_options(CLI::App& command, EditCommandOptions& options) {
    EditRequest& request = options.request;
    command.add_option("MODEL", request.model, "A " + model_extensions_text() + " file")
        ->required();
    add_setting(command, options.overrides, "from")->group("Options");
    add_setting(command, options.overrides, "to")->group("Options");
    command
        .add_option("--plan", options.plan_file,
                    "JSON file with several edits that are made one after the other; replaces "
                    "--from and --to")
        ->type_name("FILE");
    command
        .add_option("-o,--output", request.output,
                    "Folder for the model, its textures and the report")
        ->required()
        ->type_name("FOLDER");
    command
        .add_option("--prior", options.prior,
                    "Diffusion model: a folder in the diffusers layout, or a name (`item3d prior "
                    "list`). Default: the embedded prior")
        ->type_name("PRIOR");
    command.add_flag("--resume", request.resume,
                     "Continue from the checkpoint in the output folder");
    add_texture_folders(command, request.texture_folders);
    command.add_flag(
        "--allow-missing-textures", request.allow_missing_textures,
        "Edit a material whose base colour texture cannot be read as if it had no texture");
    command
        .add_option("--image-size", request.image_pixels,
                    "Edge length of the images in the report, in pixels")
        ->check(CLI::Range(16, 2048))
        ->capture_default_str();
    add_sign_key(command, options.sign_key);
    add_with_help(command, options.overrides, "method", print_methods);
    add_with_help(command, options.overrides, "guidance", print_guidance_kinds);
    add_settings(command, options.overrides);
    add_network_options(command, request);
}

void add_edit_command(CLI::App& app) {
    auto options = std::make_shared<EditCommandOptions>();
    CLI::App* command = add_command(app, "edit", *options);
    add_edit_options(*command, *options);
    command
        ->add_option("--live", options->request.live,
                     "Folder for small textures of the running edit, updated about once a second, "
                     "for programs that show the progress")
        ->type_name("FOLDER");
    command->footer(
        "A prior may set other defaults (`item3d prior info`).\nUnder torchrun, several processes "
        "or machines share one edit (docs/clusters.md).");
    command->callback([options] {
        options->request.command = command_line();
        run_edit(*options);
    });
}

}  // namespace item3d
