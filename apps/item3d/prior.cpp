// item3d prior: train the embedded prior, look at what it is trained on, fetch and verify others.
#include "command.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/hub/find_prior.h"
#include "item3d/prior/captions.h"
#include "item3d/prior/train.h"
#include "item3d/prior/vision_language.h"
#include "item3d/prior/vocabulary.h"
#include "item3d/scene/io/save.h"
#include "prior_commands.h"

namespace item3d {
namespace {

struct TrainOptions : CommonOptions {
    TrainSettings settings;
    std::string output;
    std::string work;
    std::string part = "all";
};

void run_train(const TrainOptions& options) {
    const bool all = options.part == "all";
    if (all || options.part == "diffusion") train_prior(options.settings);
    if (all || options.part != "diffusion")
        train_vision_language(options.settings, all || options.part == "clip",
                              all || options.part == "captioner");
}

void add_train(CLI::App& app) {
    auto options = std::make_shared<TrainOptions>();
    CLI::App* command =
        add_command(app, "train", "Train the embedded prior from nothing", *options);
    TrainSettings& settings = options->settings;
    command->add_option("-o,--output", options->output, "Folder to write the prior to")->required();
    command->add_option("--work", options->work,
                        "Folder for data and checkpoints; without it, work/ in the output folder");
    command
        ->add_option("--part", options->part,
                     "What to train: diffusion (autoencoder, text encoder and U-Net), clip, "
                     "captioner, or all")
        ->check(CLI::IsMember({"all", "diffusion", "clip", "captioner"}))
        ->capture_default_str();
    command
        ->add_option("--clip-samples", settings.clip_samples,
                     "Pictures that CLIP learns from, repetitions counted")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option("--captioner-samples", settings.captioner_samples,
                     "Pictures that the captioner learns from, repetitions counted")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option("--labeled-data", settings.labeled_samples,
                     "Different pictures for CLIP and the captioner")
        ->check(CLI::Range(256, 10000000))
        ->capture_default_str();
    command
        ->add_option("--samples", settings.samples, "Pictures to learn from, repetitions counted")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->add_option("--data", settings.data_samples, "Different pictures")
        ->check(CLI::Range(64, 10000000))
        ->capture_default_str();
    command
        ->add_option("--autoencoder-samples", settings.autoencoder_samples,
                     "Pictures that the autoencoder learns from, repetitions counted")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option("--autoencoder-data", settings.autoencoder_pictures,
                     "Different pictures for the autoencoder")
        ->check(CLI::Range(32, 1000000))
        ->capture_default_str();
    command->add_option("--variants", settings.shape_variants, "Shapes of each class")
        ->check(CLI::Range(1, 30))
        ->capture_default_str();
    command->add_option("--views", settings.views_each, "Views of each shape")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--lights", settings.lights, "Different lights")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command
        ->add_option("--batch", settings.batch,
                     "Pictures a step and replica that the U-Net learns from")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command
        ->add_option("--replicas", settings.replicas, "Copies of the model that train in parallel")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    command->add_option("--learning-rate", settings.learning_rate, "Highest learning rate")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->add_option("--seed", settings.seed, "Of everything random")->capture_default_str();
    command->add_option("--stop-after", settings.stop_after,
                        "End after so many pictures, to go on later with --resume");
    command->add_flag("--resume", settings.resume, "Go on from the checkpoint in the work folder");
    command->callback([options] {
        start_command(*options);
        options->settings.output = options->output;
        options->settings.work = options->work.empty() ? options->settings.output / "work"
                                                       : std::filesystem::path(options->work);
        run_train(*options);
    });
}

struct PicturesOptions : CommonOptions {
    std::string output;
    int columns = 8;
    int rows = 8;
    int variants = 2;
    std::uint64_t seed = 1;
};

/// A contact sheet of training pictures; their captions go to stdout, row by row.
void run_pictures(const PicturesOptions& options) {
    std::vector<TrainingLight> lights = make_training_lights(options.seed + 1, 64, 2);
    const ExampleSource source(make_view_pool(false, options.variants, 4, options.seed, 2),
                               std::move(lights), options.seed);
    constexpr int tile = picture_size + 2;
    Image sheet(options.columns * tile, options.rows * tile, 3, 1.0f);
    nlohmann::json captions = nlohmann::json::array();
    for (int i = 0; i < options.columns * options.rows; ++i) {
        const Example example = source.draw(i);
        const auto* pixels = example.image.data_ptr<float>();
        for (int y = 0; y < picture_size; ++y)
            for (int x = 0; x < picture_size; ++x)
                for (int c = 0; c < 3; ++c)
                    sheet.at(i % options.columns * tile + x, i / options.columns * tile + y, c) =
                        pixels[(y * picture_size + x) * 3 + c];
        captions.push_back(example.caption);
        if (!options.json) fmt::print("{}\n", example.caption);
    }
    save_image(options.output, sheet);
    if (options.json) print_json({{"captions", captions}});
}

void add_pictures(CLI::App& app) {
    auto options = std::make_shared<PicturesOptions>();
    CLI::App* command = add_command(app, "pictures", "Draw a sheet of training pictures", *options);
    command->add_option("-o,--output", options->output, "Image file")->required();
    command->add_option("--columns", options->columns)
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--rows", options->rows)->check(CLI::Range(1, 64))->capture_default_str();
    command->add_option("--variants", options->variants, "Shapes of each class")
        ->check(CLI::Range(1, 30))
        ->capture_default_str();
    command->add_option("--seed", options->seed)->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_pictures(*options);
    });
}

struct FolderOptions : CommonOptions {
    std::string folder;
};

void print_vocabulary(const nlohmann::json& prior, const std::string& subject) {
    const PriorVocabulary vocabulary(prior, subject);
    std::vector<std::string> kinds;
    for (const KnownWord& word : vocabulary.words())
        if (kinds.empty() || kinds.back() != word.kind) kinds.push_back(word.kind);
    fmt::print("{}\n", prior.value("name", subject));
    if (prior.contains("train")) {
        const auto& train = prior.at("train");
        fmt::print("trained on {} pictures in {}, loss {:.3f}, autoencoder {:.1f} dB\n",
                   train.value("samples", 0), format_duration(train.value("seconds", 0.0)),
                   train.value("loss", 0.0), train.value("psnr", 0.0));
    }
    const auto part = [](const nlohmann::json& from, const char* name) {
        return 100 * from.value(name, 0.0);
    };
    if (prior.contains("clip") && prior["clip"].contains("retrieval")) {
        const auto& found = prior["clip"]["retrieval"];
        fmt::print("clip: finds the right one of {} captions for {:.0f} % of held-out pictures\n",
                   found.value("candidates", 0), part(found, "picture_to_caption"));
    }
    if (prior.contains("captioner") && prior["captioner"].contains("captions")) {
        const auto& named = prior["captioner"]["captions"];
        fmt::print(
            "captioner: names the object of {:.0f} %, the material of {:.0f} %, one of them "
            "of {:.0f} %\n",
            part(named, "object"), part(named, "material"), part(named, "object_or_material"));
    }
    if (kinds.empty()) fmt::print("not measured: see `item3d prior measure`\n");
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

void add_folder_commands(CLI::App& app) {
    auto info = std::make_shared<FolderOptions>();
    CLI::App* command =
        add_command(app, "info", "List what a prior knows, with its accuracy a word", *info);
    command->add_option("PRIOR", info->folder,
                        "Its folder or name; without it, the embedded prior");
    command->callback([info] {
        start_command(*info);
        const auto file = find_prior(info->folder) / "prior.json";
        if (!std::filesystem::exists(file))
            throw InputError(file.string(), "no such file: this prior does not list its words",
                             "`item3d prior verify` says what else it is");
        const auto prior = nlohmann::json::parse(read_text(file), nullptr, false);
        if (!prior.is_object()) throw InputError(file.string(), "is not a JSON object");
        if (info->json)
            print_json(prior);
        else
            print_vocabulary(prior, file.string());
    });
    auto measure = std::make_shared<FolderOptions>();
    command =
        add_command(app, "measure", "Measure a prior on held-out shapes, word by word", *measure);
    command->add_option("PRIOR", measure->folder, "Its folder or name")->required();
    command->callback([measure] {
        start_command(*measure);
        const auto prior = write_measurement(find_prior(measure->folder), at::get_num_threads());
        if (measure->json)
            print_json(prior);
        else
            print_vocabulary(prior, measure->folder);
    });
}

}  // namespace

void add_prior_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("prior", "Train, fetch and inspect priors");
    command->require_subcommand(1);
    add_train(*command);
    add_folder_commands(*command);
    add_prior_pull(*command);
    add_prior_verify(*command);
    add_pictures(*command);
}

}  // namespace item3d
