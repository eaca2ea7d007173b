// Command item3d prior: trains the embedded prior, shows its training data, and fetches and
// verifies other priors.
#include "apps/item3d/command.h"
#include "apps/item3d/train/commands.h"
#include "apps/item3d/train/prior_commands.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/save.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/prior/evaluation/contact_sheets.h"
#include "item3d/prior/training/segmenter_training.h"
#include "item3d/prior/training/settings.h"
#include "item3d/prior/training/train.h"
#include "item3d/prior/training/vision_language.h"

#include <functional>
#include <utility>

namespace item3d {
namespace {

struct TrainOptions : CommonOptions {
    TrainSettings settings;
    std::string output;
    std::string work;
    std::string part = "all";
    std::string recipe = "embedded";
    CLI::Option* replicas = nullptr;
    /// Functions that apply the given options to the settings of a recipe.
    std::vector<std::function<void(TrainSettings&)>> given;

    /// Returns the recipe with the given options applied.
    TrainSettings chosen() const {
        TrainSettings result = train_recipe(recipe);
        for (const auto& put : given)
            put(result);
        result.output = output;
        result.work = work.empty() ? result.output / "work" : std::filesystem::path(work);
        return result;
    }
};

/// Adds an option for a member of the settings.
template <class Value>
CLI::Option* add_setting(CLI::App& command, TrainOptions& options, const std::string& name,
                         Value TrainSettings::*member, const std::string& help) {
    CLI::Option* option = command.add_option(name, options.settings.*member, help);
    options.given.emplace_back([&options, option, member](TrainSettings& to) {
        if (option->count() > 0) to.*member = options.settings.*member;
    });
    return option;
}

void run_train(const TrainOptions& options, at::Device device) {
    TrainSettings settings = options.chosen();
    // The weights depend on the device, so a training uses CUDA only on request.
    settings.device = options.device == "cuda" ? device : at::Device(at::kCPU);
    if (!settings.device.is_cpu()) {
        if (options.replicas->count() > 0 && settings.replicas > 1)
            throw InputError("--replicas", "a CUDA device trains one replica",
                             "leave it out, or train with --device cpu");
        settings.replicas = 1;
    }
    settings.processes = ProcessGroup::from_environment();
    if (settings.processes.size() > 1)
        note(fmt::format("process {} of {} has joined", settings.processes.rank(),
                         settings.processes.size()));
    const bool all = options.part == "all";
    if (options.part == "instruct") {
        settings.condition = image_condition;
        if (settings.init_from.empty()) settings.init_from = find_prior("");
        train_prior(settings);
    }
    if (all || options.part == "diffusion") train_prior(settings);
    const bool clip = all || options.part == "clip";
    const bool captioner = all || options.part == "captioner";
    if (clip || captioner) train_vision_language(settings, clip, captioner);
    if (all || options.part == "segmenter") train_segmenter_part(settings);
}

void add_network_settings(CLI::App& command, TrainOptions& options) {
    add_setting(command, options, "--resolution", &TrainSettings::resolution,
                "Edge length of the images, in pixels")
        ->check(CLI::IsMember({64, 128}))
        ->capture_default_str();
    add_setting(command, options, "--widths", &TrainSettings::widths,
                "Channels of the U-Net's levels: 48,96,144")
        ->type_name("N,N,...")
        ->delimiter(',')
        ->check(CLI::IsMember({16, 32, 48, 64, 96, 128, 144, 160, 192, 224, 256, 320, 384, 512}))
        ->expected(2, 4)
        ->capture_default_str();
    add_setting(command, options, "--prediction", &TrainSettings::prediction_type,
                "What the U-Net predicts")
        ->check(CLI::IsMember({"v_prediction", "epsilon"}))
        ->capture_default_str();
    add_setting(command, options, "--optimizer", &TrainSettings::optimizer,
                "Optimizer of the weight matrices")
        ->check(CLI::IsMember({"adamw", "muon"}))
        ->capture_default_str();
    add_setting(command, options, "--condition", &TrainSettings::condition,
                "Condition of the U-Net: surface (depth, position, normal), depth, none")
        ->check(CLI::IsMember({"surface", "depth", "none"}))
        ->capture_default_str();
    add_setting(command, options, "--batch", &TrainSettings::batch,
                "Images per step and replica of the U-Net")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    options.replicas =
        add_setting(command, options, "--replicas", &TrainSettings::replicas,
                    "Replicas of the model that a process trains in parallel; 1 on a CUDA device")
            ->check(CLI::Range(1, 256))
            ->capture_default_str();
    add_setting(command, options, "--learning-rate", &TrainSettings::learning_rate,
                "Peak learning rate; twice as high for the captioner")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
}

void add_count_settings(CLI::App& command, TrainOptions& options) {
    const auto add = [&](const char* name, auto member, const char* help) {
        return add_setting(command, options, name, member, help)->capture_default_str();
    };
    add("--clip-samples", &TrainSettings::clip_samples,
        "Training images of CLIP, including repetitions")
        ->check(CLI::PositiveNumber);
    add("--captioner-samples", &TrainSettings::captioner_samples,
        "Training images of the captioner, including repetitions")
        ->check(CLI::PositiveNumber);
    add("--segmenter-samples", &TrainSettings::segmenter_samples,
        "Training images of the segmenter, including repetitions")
        ->check(CLI::PositiveNumber);
    add("--segmenter-batch", &TrainSettings::segmenter_batch,
        "Images per step and replica of the segmenter")
        ->check(CLI::Range(1, 4096));
    add("--part-data", &TrainSettings::part_samples, "Different images for the segmenter")
        ->check(CLI::Range(16, 10000000));
    add("--part-variants", &TrainSettings::part_variants, "Shapes of each class for the segmenter")
        ->check(CLI::Range(1, 10000));
    add("--labeled-data", &TrainSettings::labeled_samples,
        "Different images for CLIP and the captioner")
        ->check(CLI::Range(256, 10000000));
    add("--labeled-variants", &TrainSettings::labeled_variants,
        "Shapes of each class for CLIP and the captioner")
        ->check(CLI::Range(1, 10000));
    add("--samples", &TrainSettings::samples, "Training images of the U-Net, including repetitions")
        ->check(CLI::PositiveNumber);
    add("--data", &TrainSettings::data_samples, "Different images for the U-Net")
        ->check(CLI::Range(64, 10000000));
    add("--autoencoder-samples", &TrainSettings::autoencoder_samples,
        "Training images of the autoencoder, including repetitions")
        ->check(CLI::PositiveNumber);
    add("--autoencoder-data", &TrainSettings::autoencoder_images,
        "Different images for the autoencoder")
        ->check(CLI::Range(32, 1000000));
    add("--variants", &TrainSettings::shape_variants, "Shapes of each class")
        ->check(CLI::Range(1, 10000));
    add("--views", &TrainSettings::views_each, "Views of each shape")->check(CLI::Range(1, 1000));
    add("--lights", &TrainSettings::lights, "Different lights")->check(CLI::Range(1, 100000));
    add("--patterns", &TrainSettings::pattern_weight,
        "Relative frequency of patterns; at 1, 39 % of the images have a pattern")
        ->check(CLI::Range(0.0, 100.0));
}

void add_train(CLI::App& app) {
    auto options = std::make_shared<TrainOptions>();
    CLI::App* command =
        add_command(app, "train", "Train the embedded prior from scratch", *options);
    command->add_option("-o,--output", options->output, "Folder for the prior")
        ->type_name("FOLDER")
        ->required();
    command
        ->add_option("--work", options->work,
                     "Folder for data and checkpoints. Default: work/ in the output folder")
        ->type_name("FOLDER");
    command
        ->add_option("--recipe", options->recipe,
                     "Named set of settings; options override them. The defaults shown are those "
                     "of embedded")
        ->check(CLI::IsMember(train_recipe_names()))
        ->capture_default_str();
    command
        ->add_option("--part", options->part,
                     "Part to train: diffusion (autoencoder, text encoder and U-Net), clip, "
                     "captioner, segmenter, all of these, or instruct (an InstructPix2Pix, "
                     "initialized from the embedded prior)")
        ->check(CLI::IsMember({"all", "diffusion", "clip", "captioner", "segmenter", "instruct"}))
        ->capture_default_str();
    add_count_settings(*command, *options);
    add_network_settings(*command, *options);
    CLI::Option* begin =
        command
            ->add_option("--init-from", options->settings.init_from,
                         "Prior to initialize from, by folder or name: weights, words and "
                         "autoencoder, and captioner and CLIP if they are trained")
            ->type_name("PRIOR");
    options->given.emplace_back([options = options.get(), begin](TrainSettings& to) {
        if (begin->count() > 0) to.init_from = find_prior(options->settings.init_from);
    });
    CLI::Option* autoencoder =
        command
            ->add_option(
                "--autoencoder", options->settings.autoencoder,
                "Prior, by folder or name, whose autoencoder is used instead of training one")
            ->type_name("PRIOR");
    options->given.emplace_back([options = options.get(), autoencoder](TrainSettings& to) {
        if (autoencoder->count() > 0) to.autoencoder = find_prior(options->settings.autoencoder);
    });
    add_setting(*command, *options, "--seed", &TrainSettings::seed, "Seed of all random numbers")
        ->check(seed_check())
        ->capture_default_str();
    add_setting(*command, *options, "--word-images", &TrainSettings::word_images,
                "Held-out images per word, in the test at the end")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    add_setting(*command, *options, "--stop-after", &TrainSettings::stop_after,
                "Number of images after which the training stops, for a later --resume");
    CLI::Option* resume = command->add_flag("--resume", options->settings.resume,
                                            "Continue from the checkpoint in the work folder");
    options->given.emplace_back([resume](TrainSettings& to) { to.resume = resume->count() > 0; });
    command->footer(
        "With RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT set, as by torchrun, several processes "
        "or machines train one prior.");
    command->callback([options] { run_train(*options, start_command(*options)); });
}

struct ImagesOptions : CommonOptions {
    std::string output;
    std::string of = "examples";
    SheetOptions sheet;
};

/// Writes a contact sheet of training images, and prints their captions row by row.
void run_images(const ImagesOptions& options) {
    const Sheet sheet = options.of == "objects"        ? object_sheet(options.sheet)
                        : options.of == "instructions" ? instruction_sheet(options.sheet)
                        : options.of == "materials"    ? material_sheet(options.sheet)
                        : options.of == "lights"       ? light_sheet(options.sheet)
                                                       : example_sheet(options.sheet);
    save_image(options.output, sheet.image);
    if (options.json) {
        print_json({{"captions", sheet.captions}});
    } else {
        for (const std::string& caption : sheet.captions)
            fmt::print("{}\n", caption);
    }
}

void add_images(CLI::App& app) {
    auto options = std::make_shared<ImagesOptions>();
    CLI::App* command =
        add_command(app, "pictures", "Render a contact sheet of training images", *options);
    SheetOptions& sheet = options->sheet;
    command->add_option("-o,--output", options->output, "Image file to write")
        ->type_name("FILE")
        ->required();
    command
        ->add_option("--of", options->of,
                     "Images to render: examples, pairs of instructions, or each of the objects, "
                     "materials or lights")
        ->check(CLI::IsMember({"examples", "instructions", "objects", "materials", "lights"}))
        ->capture_default_str();
    command->add_option("--columns", sheet.columns, "Columns of the sheet")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--rows", sheet.rows, "Rows of examples")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--resolution", sheet.image, "Edge length of an image, in pixels")
        ->check(CLI::IsMember({48, 64, 96, 128}))
        ->capture_default_str();
    command->add_option("--variants", sheet.variants, "Shapes of each class, for examples")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    command->add_option("--seed", sheet.seed, "Seed of all random numbers")
        ->check(seed_check())
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_images(*options);
    });
}

struct FolderOptions : CommonOptions {
    std::string folder;
};

/// Returns the number of images that a training has seen. It includes the images seen by the prior
/// from which the training was initialized.
std::int64_t images_seen(const nlohmann::json& train) {
    const std::int64_t before = train.contains("begun_with") ? images_seen(train["begun_with"]) : 0;
    return before + train.value("samples", std::int64_t{0});
}

void print_vocabulary(const nlohmann::json& prior, const std::string& subject) {
    const PriorVocabulary vocabulary(prior, subject);
    std::vector<std::string> kinds;
    for (const KnownWord& word : vocabulary.words())
        if (kinds.empty() || kinds.back() != word.kind) kinds.push_back(word.kind);
    fmt::print("{}\n", prior.value("name", subject));
    if (prior.contains("train")) {
        const auto& train = prior.at("train");
        if (train.contains("begun_with"))
            fmt::print("initialized from a prior trained on {} images, then ",
                       images_seen(train["begun_with"]));
        fmt::print("trained on {:.0f} images in {}, loss {:.3f}, autoencoder {:.1f} dB\n",
                   train.value("samples", 0.0), format_duration(train.value("seconds", 0.0)),
                   train.value("loss", 0.0), train.value("psnr", 0.0));
    }
    const auto part = [](const nlohmann::json& from, const char* name) {
        return 100 * from.value(name, 0.0);
    };
    if (prior.contains("clip") && prior["clip"].contains("retrieval")) {
        const auto& found = prior["clip"]["retrieval"];
        fmt::print("clip: finds the right one of {:.0f} captions for {:.0f} % of held-out images\n",
                   found.value("candidates", 0.0), part(found, "picture_to_caption"));
    }
    for (const auto& [member, what] : {std::pair{"captions", "an image in any light"},
                                       std::pair{"model_captions", "a model from four sides"}}) {
        if (!prior.contains("captioner") || !prior["captioner"].contains(member)) continue;
        const auto& named = prior["captioner"][member];
        fmt::print(
            "captioner: for {}, the object is right in {:.0f} %, the material in {:.0f} %, both in "
            "{:.0f} %\n",
            what, part(named, "object"), part(named, "material"), part(named, "both"));
    }
    if (prior.contains("segmenter") && prior["segmenter"].contains("parts")) {
        const auto& found = prior["segmenter"]["parts"];
        fmt::print(
            "segmenter: intersection over union {:.2f} of named parts, {:.2f} on classes that were "
            "not trained on\n",
            found.value("part_iou", 0.0), found.value("new_class_iou", 0.0));
    }
    if (kinds.empty()) fmt::print("not measured: run `item3d prior evaluate`\n");
    for (const std::string& kind : kinds) {
        fmt::print("\n{}\n", kind);
        for (const KnownWord& word : vocabulary.words_of(kind)) {
            std::string spellings;
            for (const std::string& spelling : word.spellings)
                if (spelling != word.word) spellings += (spellings.empty() ? "" : ", ") + spelling;
            fmt::print("  {:12} {:4.0f} % {} {}\n", word.word, 100 * word.accuracy,
                       word.accuracy < weak_accuracy ? "weak" : "    ", spellings);
        }
    }
}

void add_info(CLI::App& app) {
    auto info = std::make_shared<FolderOptions>();
    CLI::App* command = add_command(
        app, "info", "List the words that a prior knows, with the accuracy of each", *info);
    command->add_option("PRIOR", info->folder,
                        "Folder or name of the prior. Default: the embedded prior");
    command->callback([info] {
        start_command(*info);
        const auto file = find_prior(info->folder) / "prior.json";
        if (!std::filesystem::exists(file))
            throw InputError(file.string(), "no such file: this prior does not list its words",
                             "run `item3d prior verify` for its networks");
        const auto prior = parse_json(read_text(file));
        if (!prior.is_object())
            throw InputError(file.string(), "is not a JSON object", "download the prior again");
        if (info->json)
            print_json(prior);
        else
            print_vocabulary(prior, file.string());
    });
}

}  // namespace

void add_prior_command(CLI::App& app) {
    CLI::App* command = add_command_group(app, "prior");
    command->require_subcommand(1);
    add_train(*command);
    add_prior_list(*command);
    add_info(*command);
    add_prior_evaluate(*command);
    add_prior_pull(*command);
    add_prior_verify(*command);
    add_images(*command);
}

}  // namespace item3d
