// item3d generate: pictures that a prior draws from a prompt, on the depth of a model if given one.
#include "command.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/hub/find_prior.h"
#include "item3d/models/pipeline.h"
#include "item3d/prior/vocabulary.h"
#include "item3d/render/rasterize.h"
#include "item3d/render/shade.h"
#include "item3d/scene/io/load.h"
#include "item3d/scene/io/save.h"
#include "picture_options.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

namespace {

namespace fs = std::filesystem;

struct GenerateCommand : CommonOptions {
    GenerateOptions generate;
    std::string output;
    std::string prior;
    std::string size;
    std::string like;
    float guidance_scale = 0;  ///< 0: the prior's
    int steps = 0;             ///< 0: the prior's
};

/// What the prior's own prior.json recommends ("generate": {"steps", "guidance_scale"}), where it
/// has one: weights from elsewhere keep the usual defaults.
void apply_prior_defaults(const fs::path& prior, GenerateOptions& options) {
    if (!fs::exists(prior / "prior.json")) return;
    const Config config = Config::read(prior / "prior.json");
    if (!config.has("generate")) return;
    const Config defaults(config.json().at("generate"), config.subject() + ": generate");
    options.steps = defaults.size("steps", options.steps);
    options.guidance_scale =
        static_cast<float>(defaults.number("guidance_scale", options.guidance_scale));
}

/// The depth of a model from the default view, on the latents' grid: [1, 1, h, w].
torch::Tensor depth_of(const std::string& file, PictureSize size, const Pipeline& pipeline) {
    const Model model = load_model(file);
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const Camera camera = default_view(model, aspect);
    const Raster raster = rasterize(Geometry::from_model(model, pipeline.device()), {camera},
                                    size.width, size.height);
    return depth_condition(raster.depth, pipeline.downscale());
}

/// One name for each picture: `output` itself, or numbered ones of its kind.
std::vector<fs::path> choose_files(const fs::path& output, int count) {
    if (output.extension() != ".png")
        throw UsageError(fmt::format("-o {}: expected the name of a .png file", output.string()));
    if (fs::is_directory(output))
        throw InputError(output.string(), "is a folder, expected a name for a picture");
    if (output.has_parent_path()) make_output_folder(output.parent_path());
    if (count == 1) return {output};
    std::vector<fs::path> files;
    for (int i = 0; i < count; ++i)
        files.push_back(output.parent_path() /
                        fmt::format("{}_{:03}.png", output.stem().string(), i));
    return files;
}

void run_generate(const GenerateCommand& command, torch::Device device) {
    if (command.generate.prompt.find_first_not_of(" \t\n") == std::string::npos)
        throw InputError("PROMPT", "is empty", "say what to draw, as in \"a golden vase\"");
    const std::vector<fs::path> files = choose_files(command.output, command.generate.count);
    const fs::path prior = find_prior(command.prior);
    const Pipeline pipeline = Pipeline::load(prior, device);
    const std::string warning =
        PriorVocabulary::load(prior).warning(command.generate.prompt, !command.like.empty());
    if (!warning.empty()) warn(warning);

    GenerateOptions options = command.generate;
    apply_prior_defaults(prior, options);
    if (command.steps > 0) options.steps = command.steps;
    if (command.guidance_scale > 0) options.guidance_scale = command.guidance_scale;
    const int native = pipeline.unet->config().sample_size * pipeline.downscale();
    const PictureSize size =
        command.size.empty() ? PictureSize{native, native} : parse_size(command.size);
    options.width = size.width;
    options.height = size.height;

    torch::Tensor condition;
    const int channels = pipeline.condition_channels();
    if (channels > 1) {
        throw InputError(prior.string(),
                         fmt::format("its U-Net takes {} further channels, which generate cannot "
                                     "fill",
                                     channels),
                         "use a text-to-image or depth-to-image model");
    }
    if (!command.like.empty()) {
        if (channels != 1)
            throw InputError(prior.string(), "its U-Net takes no depth", "leave out --like");
        condition = depth_of(command.like, size, pipeline);
    }

    const torch::Tensor images = generate(pipeline, options, condition);
    nlohmann::json names = nlohmann::json::array();
    for (std::size_t i = 0; i < files.size(); ++i) {
        save_image(files[i], to_image(images[static_cast<std::int64_t>(i)].cpu()));
        names.push_back(files[i].string());
        if (!command.json) fmt::print("{}\n", files[i].string());
    }
    if (command.json) {
        print_json({{"files", names},
                    {"prompt", options.prompt},
                    {"negative_prompt", options.negative_prompt},
                    {"prior", prior.string()},
                    {"like", command.like},
                    {"width", size.width},
                    {"height", size.height},
                    {"steps", options.steps},
                    {"guidance_scale", options.guidance_scale},
                    {"seed", options.seed}});
    }
}

}  // namespace

void add_generate_command(CLI::App& app) {
    auto options = std::make_shared<GenerateCommand>();
    CLI::App* command =
        add_command(app, "generate", "Draw pictures from a prompt with the prior alone", *options);
    command->add_option("PROMPT", options->generate.prompt, "What to draw, as in \"a golden vase\"")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "A .png file; several pictures get numbers behind its name")
        ->required();
    command->add_option(
        "--prior", options->prior,
        "A folder in the diffusers layout, or a name (item3d prior pull); without it, "
        "the prior that comes along");
    command->add_option("--negative-prompt", options->generate.negative_prompt, "What not to draw");
    command->add_option("--steps", options->steps, "Denoising steps; without it, the prior's own")
        ->check(CLI::Range(1, 1000));
    command
        ->add_option("--cfg", options->guidance_scale,
                     "Weight of the prompt (classifier-free guidance); without it, the prior's own")
        ->check(CLI::Range(0.1f, 1000.0f));
    command->add_option("--seed", options->generate.seed, "Of the noise that it starts from")
        ->capture_default_str();
    command->add_option("--count", options->generate.count, "How many pictures")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--size", options->size,
                        "WxH in pixels; without it, the size that the prior was trained on");
    command->add_option("--like", options->like,
                        "A model whose depth, seen as render sees it, the picture shall have");
    command->callback([options] { run_generate(*options, start_command(*options)); });
}

}  // namespace item3d
