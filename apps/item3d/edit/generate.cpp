// Command item3d generate: makes images from a prompt by a prior, optionally conditioned on a
// model's shape.
#include "item3d/networks/diffusion/generate.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/light_options.h"
#include "apps/item3d/edit/setting_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/networks/diffusion/generate_defaults.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/pipeline_extras.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/prior/data/shapes/shape_models.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/region/seen_shape.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/rasterize.h"
#include "item3d/report/contact_sheet.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

namespace {

namespace fs = std::filesystem;

constexpr const char* no_shape = "none";  ///< for --like

struct GenerateCommand : CommonOptions {
    GenerateOptions generate;
    std::string output;
    std::string prior;
    std::string size;
    std::string like;
    float guidance_scale = 0;                          ///< 0: the prior's
    int steps = 0;                                     ///< 0: the prior's
    nlohmann::json extras = nlohmann::json::object();  ///< given members of PipelineExtras
};

/// Sets missing options to the prior's defaults.
void complete_options(const GenerateCommand& command, const fs::path& prior,
                      const DiffusionModel& pipeline, GenerateOptions& options) {
    const GenerateOptions defaults = generate_defaults(prior, pipeline, options.scheduler);
    options.scheduler = defaults.scheduler;
    options.steps = command.steps > 0 ? command.steps : defaults.steps;
    options.guidance_scale =
        command.guidance_scale > 0 ? command.guidance_scale : defaults.guidance_scale;
}

/// Returns the condition for a model in the default view.
at::Tensor condition_of(const Model& model, ImageSize size, const DiffusionModel& pipeline) {
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const Camera camera = default_view(model, aspect);
    const Geometry geometry = Geometry::from_model(model, pipeline.device());
    const Raster raster = rasterize(geometry, {camera}, size.width, size.height);
    const Surface surface = interpolate_surface(geometry, raster, {camera});
    // Unsupported sizes are rounded up here and refused by generate().
    const int cell = pipeline.downscale();
    const auto cells = [&](int pixels) { return (pixels + cell - 1) / cell; };
    return condition_of_shape(
        pipeline, seen_shape(raster, surface, bounding_sphere(model)),
        at::empty({1, 1, cells(size.height), cells(size.width)}, pipeline.device()));
}

/// Returns the condition for a procedural shape. Each image gets another variant, as long as there
/// are more variants.
at::Tensor own_condition(const std::string& shape_class, const GenerateOptions& options,
                         const DiffusionModel& pipeline) {
    std::map<int, at::Tensor> of_variant;
    std::vector<at::Tensor> conditions;
    for (int i = 0; i < options.count; ++i) {
        Random random(options.seed, RandomStream::shape, static_cast<std::uint64_t>(i));
        const auto variant = static_cast<int>(random.index(training_variants));
        at::Tensor& condition = of_variant[variant];
        if (!condition.defined())
            condition = condition_of(shape_model(shape_class, variant),
                                     {options.width, options.height}, pipeline);
        conditions.push_back(condition);
    }
    return at::cat(conditions);
}

/// Source of the shape in the images. If both members are empty, the prompt alone determines it.
struct ShapeChoice {
    std::string model;      ///< file of a model
    std::string own_class;  ///< class of the program's procedural shapes

    bool any() const { return !model.empty() || !own_class.empty(); }
};

ShapeChoice choose_shape(const GenerateCommand& command, const DiffusionModel& pipeline,
                         const PipelineExtras& extras, const PriorVocabulary& vocabulary) {
    if (command.like == no_shape) return {};
    if (!command.like.empty()) return {command.like, ""};
    // A prior that this program did not train has not seen such shapes.
    const bool knows_ours = !vocabulary.open() && takes_shape(pipeline);
    if (!knows_ours || !extras.controlnet.empty()) return {};
    return {"", shape_named(command.generate.prompt).value_or("")};
}

/// Throws if the prior takes no shape, or requires one.
void check_shape(const ShapeChoice& shape, const fs::path& prior, const DiffusionModel& pipeline,
                 const PipelineExtras& extras) {
    const int channels = pipeline.condition_channels();
    if (channels > 1 && channels != surface_condition_channels) {
        throw InputError(
            prior.string(),
            fmt::format(
                "its U-Net takes {} additional input channels, which generate cannot provide",
                channels),
            "use a text-to-image or depth-to-image model");
    }
    if (shape.model.empty() && !extras.controlnet.empty())
        throw InputError("--controlnet", "needs the depth of a model", "give a model with --like");
    if (!shape.model.empty() && !takes_shape(pipeline))
        throw InputError(prior.string(), "its U-Net does not take depth",
                         "leave out --like, or add a depth ControlNet with --controlnet");
}

/// Returns the condition for the shape; undefined if there is no shape.
at::Tensor shape_condition(const ShapeChoice& shape, const GenerateOptions& options,
                           const DiffusionModel& pipeline) {
    if (!shape.model.empty())
        return condition_of(load_model(shape.model), {options.width, options.height}, pipeline);
    if (shape.own_class.empty()) return {};
    note(
        fmt::format("generated in the shape of a {} of the prior's own (--like MODEL: the shape of "
                    "that model; --like none: no given shape)",
                    shape.own_class));
    return own_condition(shape.own_class, options, pipeline);
}

/// Throws if `output` is not the name of a valid image file. Creates its folder.
void open_output(const fs::path& output) {
    if (output.extension() != ".png")
        throw UsageError(
            fmt::format("-o {}: expected a file name that ends in .png", output.string()));
    if (fs::is_directory(output))
        throw InputError(output.string(), "is a folder; expected a file name for the image",
                         "add a file name, such as image.png");
    make_folder_of(output);
}

/// Saves a single image as `output`. If there are several images, they get numbered names, and
/// `output` is a contact sheet. Returns the written files.
std::vector<fs::path> save_images(const fs::path& output, const at::Tensor& images) {
    if (images.size(0) == 1) {
        save_image(output, to_image(images[0].cpu()));
        return {output};
    }
    std::vector<fs::path> files{output};
    std::vector<Tile> tiles;
    for (std::int64_t i = 0; i < images.size(0); ++i) {
        files.push_back(output.parent_path() /
                        fmt::format("{}_{:03}.png", output.stem().string(), i));
        tiles.push_back({to_image(images[i].cpu()), ""});
        save_image(files.back(), tiles.back().image);
    }
    save_image(output, contact_sheet(tiles));
    return files;
}

std::string list_schedulers() {
    std::string list = "Schedulers:\n";
    for (const SamplerKind& kind : sampler_kinds())
        list += fmt::format("  {:<16} {} (default {} steps)\n", kind.name, kind.description,
                            kind.usual_steps);
    return list;
}

void run_generate(const GenerateCommand& command, at::Device device) {
    if (command.generate.prompt.find_first_not_of(" \t\n") == std::string::npos)
        throw InputError("PROMPT", "is empty", "describe the image, as in \"a golden vase\"");
    open_output(command.output);
    const fs::path prior = find_prior(command.prior);
    Pipeline pipeline = Pipeline::load(prior, device);
    const auto extras = command.extras.get<PipelineExtras>();
    pipeline.add(extras);
    const PriorVocabulary vocabulary = PriorVocabulary::load(prior);
    const ShapeChoice shape = choose_shape(command, pipeline, extras, vocabulary);
    check_shape(shape, prior, pipeline, extras);
    const std::string warning = vocabulary.warning(command.generate.prompt, shape.any());
    if (!warning.empty()) warn(warning);
    warn_of_lost_words(pipeline.tokenizer(), "PROMPT", command.generate.prompt);

    GenerateOptions options = command.generate;
    options.prompt = vocabulary.reading(options.prompt);
    complete_options(command, prior, pipeline, options);
    const int native = pipeline.native_size();
    const ImageSize size =
        command.size.empty() ? ImageSize{native, native} : parse_size(command.size);
    options.width = size.width;
    options.height = size.height;

    const at::Tensor condition = shape_condition(shape, options, pipeline);

    nlohmann::json names = nlohmann::json::array();
    for (const fs::path& file :
         save_images(command.output, generate(pipeline, options, condition))) {
        names.push_back(file.string());
        if (!command.json) fmt::print("{}\n", file.string());
    }
    if (command.json) {
        print_json({{"files", names},
                    {"prompt", options.prompt},
                    {"negative_prompt", options.negative_prompt.value_or("")},
                    {"prior", prior.string()},
                    {"like", command.like},
                    {"own_shape", shape.own_class},
                    {"width", size.width},
                    {"height", size.height},
                    {"scheduler", options.scheduler},
                    {"steps", options.steps},
                    {"guidance_scale", options.guidance_scale},
                    {"seed", options.seed},
                    {"extras", extras}});
    }
}

}  // namespace

void add_generate_command(CLI::App& app) {
    auto options = std::make_shared<GenerateCommand>();
    CLI::App* command = add_command(app, "generate", *options);
    command
        ->add_option("PROMPT", options->generate.prompt,
                     "Description of the image: \"a golden vase\"")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "A .png file. With --count, it is a contact sheet, and each image gets a "
                     "numbered file beside it")
        ->type_name("FILE")
        ->required();
    command
        ->add_option("--prior", options->prior,
                     "Diffusion model: a folder in the diffusers layout, or a name (`item3d prior "
                     "list`). Default: the embedded prior")
        ->type_name("PRIOR");
    command->add_option_function<std::string>(
        "--negative-prompt",
        [options](const std::string& text) { options->generate.negative_prompt = text; },
        "Negative prompt: what the image should not show");
    std::vector<std::string> schedulers;
    for (const SamplerKind& kind : sampler_kinds())
        schedulers.push_back(kind.name);
    command
        ->add_option("--scheduler", options->generate.scheduler,
                     "Sampler, see below. Default: the prior's own")
        ->type_name("NAME")
        ->check(CLI::IsMember(schedulers));
    command
        ->add_option("--steps", options->steps,
                     "Denoising steps. Default: the number of the prior or of the scheduler")
        ->check(CLI::Range(1, 1000));
    command
        ->add_option("--guidance-scale,--cfg", options->guidance_scale,
                     "Scale of classifier-free guidance. Default: the prior's own")
        ->check(number_between(0.1f, 1000));
    command->add_option("--seed", options->generate.seed, "Seed of the noise")
        ->check(seed_check())
        ->capture_default_str();
    command->add_option("--count", options->generate.count, "Number of images")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--size", options->size,
                     "Size in pixels, multiples of 8 for most priors. Default: the size that the "
                     "prior was trained on")
        ->type_name("WxH");
    command->add_option(
        "--like", options->like,
        "Model whose shape the image shows, in the view of `item3d render`. none: no given shape. "
        "Default: the embedded prior chooses a shape of its own for a noun that it knows");
    add_extras_options(*command, options->extras);
    command->footer(list_schedulers());
    command->callback([options] { run_generate(*options, start_command(*options)); });
}

}  // namespace item3d
