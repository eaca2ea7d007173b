// Commands item3d prior evaluate and list: evaluate a prior, and list the available priors.
#include "apps/item3d/command.h"
#include "apps/item3d/train/prior_commands.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/prior/evaluation/evaluation.h"
#include "item3d/suite/edit_suite.h"
#include "item3d/suite/held_out_meshes.h"
#include "item3d/suite/models.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions : CommonOptions {
    std::string prior;
    std::string output;
    std::vector<std::string> meshes;
    std::string part = "all";
    bool edits = false;
    bool resume = false;
    EvaluationOptions evaluation;
};

/// Runs the prior's edits of the given meshes, in a subfolder of the evaluation.
nlohmann::json run_edits(const EvaluateOptions& options) {
    SuiteOptions suite;
    suite.prior = find_prior(options.prior);
    suite.output = fs::path(options.output) / "edits";
    suite.meshes = named_meshes(options.meshes);
    if (options.edits) suite.meshes.merge(save_held_out_meshes(suite.output / "meshes"));
    suite.resume = options.resume;
    std::vector<std::string> nouns;
    for (const auto& [noun, path] : suite.meshes)
        nouns.push_back(noun);
    const auto cases = prior_suite_cases(nouns, PriorVocabulary::load(suite.prior));
    return run_edit_suite(cases, suite).at("totals");
}

/// Evaluates only the segmenter. Writes OUTPUT/parts.json, and prints the parts, worst first.
void run_evaluate_segmenter(const EvaluateOptions& options, const EvaluationOptions& evaluation) {
    const fs::path file = fs::path(options.output) / "parts.json";
    make_output_folder(options.output);
    const nlohmann::json parts = evaluate_segmenter(find_prior(options.prior), evaluation);
    write_atomically(file, parts.dump(2) + "\n");
    if (options.json) {
        print_json(parts);
        return;
    }
    for (const nlohmann::json& part : parts.at("worst"))
        fmt::print("{:12} {:.2f}  of {} images\n", part.at(0).get<std::string>(),
                   part.at(1).get<double>(),
                   parts["words"][part.at(0).get<std::string>()].at("asked").get<int>());
    fmt::print(
        "intersection over union: all parts {:.2f}, classes that were not trained on {:.2f}, "
        "objects {:.2f}, parts by their material {:.2f}; for absent parts {:.1f} % of the object "
        "is marked\n{}\n",
        parts.at("part_iou").get<double>(), parts.at("new_class_iou").get<double>(),
        parts.at("object_iou").get<double>(), parts.at("material_iou").get<double>(),
        100 * parts.at("absent_marked").get<double>(), file.string());
}

void run_evaluate(const EvaluateOptions& options) {
    EvaluationOptions evaluation = options.evaluation;
    evaluation.threads = at::get_num_threads();
    if (options.part == "segmenter") {
        run_evaluate_segmenter(options, evaluation);
        return;
    }
    if (options.edits || !options.meshes.empty()) {
        for (const auto& [noun, path] : named_meshes(options.meshes))
            load_model(path);  // reports a model's errors before the evaluation
        evaluation.edits = [&] { return run_edits(options); };
    }
    const fs::path output = options.output;
    const nlohmann::json result = evaluate_prior(find_prior(options.prior), output, evaluation);
    if (options.json) {
        print_json(result);
        return;
    }
    for (const auto& [kind, summary] : result.at("kinds").items())
        fmt::print("{:12} {:4.0f} %\n", kind, 100 * summary.at("accuracy").get<double>());
    fmt::print("{}\n", (output / "evaluate.html").string());
}

/// Entry of `prior list`.
struct ListedPrior {
    std::string name;
    fs::path folder;
    std::uint64_t bytes = 0;
    std::string remark;
};

/// Returns the size of a folder. Links are followed, and each file counts once.
std::uint64_t folder_size(const fs::path& folder) {
    std::uint64_t bytes = 0;
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(
             folder, fs::directory_options::skip_permission_denied, ignored))
        if (entry.is_regular_file(ignored)) bytes += entry.file_size(ignored);
    return bytes;
}

std::string remark_of(const fs::path& folder) {
    if (!fs::exists(folder / "model_index.json")) return "incomplete: no model_index.json";
    if (!fs::exists(folder / "prior.json")) return "open vocabulary";
    const auto json = parse_json(read_text(folder / "prior.json"));
    if (!json.is_object() || (json.contains("accuracy") && !json["accuracy"].is_number()))
        return "prior.json is broken";
    std::size_t words = 0;
    if (json.contains("vocabulary") && json["vocabulary"].is_object())
        for (const auto& kind : json["vocabulary"])
            words += kind.size();
    return words == 0 ? "not measured"
                      : fmt::format("{} words, accuracy {:.0f} %", words,
                                    100 * json.value("accuracy", 0.0));
}

ListedPrior listed(const std::string& name, const fs::path& folder) {
    return {name, folder, folder_size(folder), remark_of(folder)};
}

/// Adds the priors that were pulled from the hub. Each is listed with the snapshot of its branch
/// "main".
void add_pulled(std::vector<ListedPrior>& all) {
    const std::string prefix = "models--";
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(hub_cache_folder(), ignored)) {
        std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix)) continue;
        name = name.substr(prefix.size());
        const std::size_t dash = name.find("--");
        if (dash == std::string::npos) continue;
        name.replace(dash, 2, "/");
        try {
            const fs::path folder =
                CachedRepository(hub_cache_folder(), name).find_snapshot("main");
            // Other programs share the cache, so other contents are skipped.
            if (fs::exists(folder / "model_index.json")) all.push_back(listed(name, folder));
        } catch (const InputError& error) {
            all.push_back({name, entry.path(), 0, std::string("broken: ") + error.what()});
        }
    }
}

std::vector<ListedPrior> list_priors() {
    std::vector<ListedPrior> all{listed("embedded", find_prior("embedded"))};
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(installed_priors_folder(), ignored))
        if (entry.is_directory(ignored))
            all.push_back(listed(entry.path().filename().string(), entry.path()));
    add_pulled(all);
    std::sort(all.begin() + 1, all.end(),
              [](const ListedPrior& a, const ListedPrior& b) { return a.name < b.name; });
    return all;
}

void run_list(const CommonOptions& options) {
    const std::vector<ListedPrior> priors = list_priors();
    if (options.json) {
        nlohmann::json list = nlohmann::json::array();
        for (const ListedPrior& prior : priors)
            list.push_back({{"name", prior.name},
                            {"folder", prior.folder.string()},
                            {"bytes", prior.bytes},
                            {"remark", prior.remark}});
        print_json({{"priors", list}});
        return;
    }
    for (const ListedPrior& prior : priors)
        fmt::print("{:28} {:8.1f} MB  {}\n{:28} {}\n", prior.name,
                   static_cast<double>(prior.bytes) / 1e6, prior.remark, "", prior.folder.string());
    fmt::print(
        "\n"
        "A prior in {} can be given by its name. `item3d prior train` trains a prior,\n"
        "`item3d prior pull` downloads one.\n",
        installed_priors_folder().string());
}

}  // namespace

void add_prior_evaluate(CLI::App& prior) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = add_command(
        prior, "evaluate",
        "Measure a prior on held-out shapes: words, samples, autoencoder, scorer, captioner, "
        "segmenter",
        *options);
    command
        ->add_option("PRIOR", options->prior,
                     "Folder or name of the prior, whose prior.json is updated")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "Folder for evaluate.html, evaluate.json and sheets of samples")
        ->type_name("FOLDER")
        ->required();
    command
        ->add_option("--part", options->part,
                     "Part to measure: all, or segmenter alone (into parts.json)")
        ->check(CLI::IsMember({"all", "segmenter"}))
        ->capture_default_str();
    command->add_flag(
        "--edits", options->edits,
        "Also make ten edits of each of six held-out shapes and report them in edits/suite.html");
    command->add_option("--mesh", options->meshes, "Additional mesh for ten edits")
        ->type_name("NOUN=FILE");
    command->add_flag("--resume", options->resume,
                      "Keep the edits that an interrupted run left in the output folder");
    EvaluationOptions& evaluation = options->evaluation;
    command
        ->add_option("--word-images", evaluation.word_images,
                     "Images per word; 0: keep the accuracies of words in prior.json")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command->add_option("--images", evaluation.images, "Images for the autoencoder")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command
        ->add_option("--labeled-images", evaluation.labeled_images,
                     "Images for CLIP and the captioner")
        ->check(CLI::Range(256, 100000))
        ->capture_default_str();
    command
        ->add_option("--labeled-models", evaluation.labeled_models,
                     "Models for the captioner, each seen from four sides")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--part-images", evaluation.part_images, "Images for the segmenter")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--seed", evaluation.seed, "Seed of all random numbers")
        ->check(seed_check())
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_evaluate(*options);
    });
}

void add_prior_list(CLI::App& prior) {
    auto options = std::make_shared<CommonOptions>();
    CLI::App* command = add_command(prior, "list", "List the names that --prior accepts", *options);
    command->callback([options] {
        start_command(*options);
        run_list(*options);
    });
}

}  // namespace item3d
