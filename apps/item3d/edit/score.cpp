// Command item3d score: measures how well an edited model agrees with its sentences and preserves
// the source.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"
#include "item3d/metrics/clip_score.h"
#include "item3d/report/model_images.h"
#include "item3d/scene/far_origin.h"
#include "item3d/tensors/precision.h"

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

namespace {

struct ScoreCommand : CommonOptions {
    std::string before;
    std::string after;
    std::string from;
    std::string to;
    std::string clip;
    std::string light = "studio";
    std::string precision = "fp32";
    int views = 6;
    std::vector<std::filesystem::path> texture_folders;
};

constexpr int score_view_pixels = 384;

void print_table(const ClipScores& scores, const std::vector<double>& kept, double kept_mean) {
    fmt::print("{:8} {:>8} {:>8} {:>12} {:>12}\n", "view", "target", "before", "directional",
               "detail kept");
    const auto line = [](const std::string& name, const ClipScore& score, double detail) {
        fmt::print("{:8} {:>8.4f} {:>8.4f} {:>12.4f} {:>12.4f}\n", name, score.global,
                   score.global_before, score.directional, detail);
    };
    for (std::size_t i = 0; i < scores.views.size(); ++i)
        line(std::to_string(i), scores.views[i], kept[i]);
    line("all", scores.mean, kept_mean);
}

void check_sentence(const std::string& option, const std::string& sentence) {
    if (sentence.find_first_not_of(" \t\n") == std::string::npos)
        throw InputError(option, "the sentence is empty", "describe what the model looks like");
}

void run_score(const ScoreCommand& options, at::Device device) {
    check_sentence("--from", options.from);
    check_sentence("--to", options.to);
    const LoadOptions load{.texture_folders = options.texture_folders};
    const Model before = load_model(options.before, load);
    Model after = load_model(options.after, load);
    move_origin(after, before.origin);
    const Clip clip =
        Clip::load_to_run(options.clip, device, choose_precision(options.precision, device));
    clip.warn_of_lost_words("--from", options.from);
    clip.warn_of_lost_words("--to", options.to);
    const EnvironmentLight light = prefilter(load_light(options.light), 256, device);
    // Both models get the same cameras, so that a moved or shrunken model is visible.
    const std::vector<Camera> cameras = image_cameras(before, options.views);
    const at::Tensor was = draw_images(before, light, cameras, score_view_pixels);
    const at::Tensor is = draw_images(after, light, cameras, score_view_pixels);
    const at::Tensor before_images = over_white(was), after_images = over_white(is);
    const auto begin = std::chrono::steady_clock::now();
    const ClipScores scores =
        clip_scores(clip, before_images, after_images, options.from, options.to);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;

    std::vector<double> kept;
    for (std::int64_t i = 0; i < was.size(0); ++i)
        kept.push_back(detail_kept(was.narrow(0, i, 1), is.narrow(0, i, 1)));
    const double kept_mean = detail_kept(was, is);
    if (!options.json) {
        print_table(scores, kept, kept_mean);
        return;
    }
    nlohmann::json views = scores.views;
    for (std::size_t i = 0; i < kept.size(); ++i)
        views[i]["detail_kept"] = kept[i];
    nlohmann::json result = scores.mean;
    result.update({{"before", options.before},
                   {"after", options.after},
                   {"from", options.from},
                   {"to", options.to},
                   {"clip", options.clip},
                   {"detail_kept", kept_mean},
                   {"seconds", took.count()},
                   {"views", views}});
    print_json(result);
}

}  // namespace

void add_score_command(CLI::App& app) {
    auto options = std::make_shared<ScoreCommand>();
    CLI::App* command = add_command(app, "score", *options);
    command->add_option("BEFORE", options->before, "Model before the edit")->required();
    command->add_option("AFTER", options->after, "Model after the edit")->required();
    add_texture_folders(*command, options->texture_folders);
    command
        ->add_option("--from", options->from, "Sentence that describes the model before the edit")
        ->required();
    command->add_option("--to", options->to, "Sentence that describes the model after the edit")
        ->required();
    command
        ->add_option("--clip", options->clip,
                     "CLIP in the transformers layout. Default: the embedded prior's, which only "
                     "knows the prior's words")
        ->type_name("FOLDER");
    command->add_option("--views", options->views, "Views around each model")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--precision", options->precision,
                     "Precision of the network: fp32 (as the reference), bf16 (faster)")
        ->capture_default_str();
    command
        ->add_option("--light", options->light,
                     "Light: " + light_presets_text() + ", or an .hdr or .exr file")
        ->type_name("LIGHT")
        ->capture_default_str();
    command->callback([options] {
        const at::Device device = start_command(*options);
        options->clip = given_or_embedded(options->clip, "clip", "--clip");
        run_score(*options, device);
    });
}

}  // namespace item3d
