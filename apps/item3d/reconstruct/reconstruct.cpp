// Command item3d reconstruct: makes a model and its light from photographs.
#include "item3d/reconstruct/reconstruct.h"

#include "apps/item3d/command.h"
#include "apps/item3d/reconstruct/commands.h"
#include "apps/item3d/sign_key_option.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/metrics/color.h"
#include "item3d/reconstruct/dataset/find_poses.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

namespace {

struct ReconstructCommand : CommonOptions {
    ReconstructRequest request;
    std::string background;
    std::filesystem::path from_images;
    bool move_vertices = false;
    bool no_normal_map = false;
    bool no_shadows = false;
    std::string poses = "auto";
    bool keep_exposure = false;
    std::string provenance = "on";
    SignKeyOption sign_key;
    int cells = 96;
    std::uint64_t seed = 0;
    std::vector<std::filesystem::path> relit;
    std::vector<std::string> relit_lights;
    std::vector<float> relit_exposures;
};

/// Returns the relit views. Each folder has one light, and optionally an exposure.
std::vector<RelitViews> relit_views(const ReconstructCommand& options) {
    if (options.relit_lights.size() != options.relit.size())
        throw UsageError("--relit: give the light of each folder with --relit-light");
    if (options.relit_exposures.size() > options.relit.size())
        throw UsageError("--relit-exposure: given more often than --relit");
    std::vector<RelitViews> views;
    for (std::size_t i = 0; i < options.relit.size(); ++i)
        views.push_back({options.relit[i], options.relit_lights[i],
                         i < options.relit_exposures.size() ? options.relit_exposures[i] : 0.0f});
    return views;
}

ReconstructRequest make_request(const ReconstructCommand& options) {
    ReconstructRequest request = options.request;
    if (!options.background.empty())
        request.dataset_options.background = parse_color(options.background);
    request.move_vertices = request.mesh.empty() || options.move_vertices;
    request.refine.normal_map = !options.no_normal_map;
    request.refine.shadows = !options.no_shadows;
    request.corrections = {.poses = options.poses == "keep"     ? PoseRefinement::keep
                                    : options.poses == "refine" ? PoseRefinement::refine
                                                                : PoseRefinement::automatic,
                           .exposure = !options.keep_exposure};
    request.shape.cells = {options.cells / 2, options.cells};
    request.shape.seed = request.refine.seed = options.seed;
    request.relit = relit_views(options);
    request.says_provenance = options.provenance == "on";
    request.sign_key = options.sign_key.load();
    request.command = command_line();
    return request;
}

/// Runs COLMAP on photographs without poses and sets the dataset of `request`.
void take_found_poses(const ReconstructCommand& options, ReconstructRequest& request) {
    DatasetOptions& dataset = request.dataset_options;
    if (dataset.masks.empty() && std::filesystem::is_directory(options.from_images / "masks"))
        dataset.masks = options.from_images / "masks";
    request.dataset =
        find_poses({options.from_images, dataset.masks, request.output, options.threads});
    dataset.images = options.from_images;
}

void run_reconstruct(const ReconstructCommand& options) {
    if (options.provenance == "off" && !options.sign_key.path.empty())
        throw UsageError(
            "--sign-key cannot be used with --provenance off, which writes nothing to sign");
    ReconstructRequest request = make_request(options);
    if (options.from_images.empty() == request.dataset.empty())
        throw UsageError("give a DATASET, or --from-images FOLDER for photographs without poses");
    if (!options.from_images.empty()) take_found_poses(options, request);
    const nlohmann::json summary = reconstruct(request);
    if (options.json) {
        print_json(summary);
        return;
    }
    const auto& scores = summary["scores"];
    const auto& chosen = scores["test"].is_null() ? scores["train"] : scores["test"];
    fmt::print("{}: {} views {:.2f} dB, SSIM {:.3f}\n", (request.output / "model.glb").string(),
               scores["test"].is_null() ? "training" : "held-out", chosen["psnr"].get<double>(),
               chosen["ssim"].get<double>());
}

void add_dataset_options(CLI::App& command, ReconstructCommand& options) {
    DatasetOptions& dataset = options.request.dataset_options;
    command.add_option("--images", dataset.images, "Folder of the images, for COLMAP and LLFF")
        ->type_name("FOLDER");
    command.add_option("--masks", dataset.masks, "Folder of masks, named like the images")
        ->type_name("FOLDER");
    command
        .add_option("--background", options.background,
                    "Background colour, instead of masks: a name, #rrggbb or r,g,b")
        ->type_name("COLOUR");
    command
        .add_option("--longest-side", dataset.longest_side,
                    "Longest side that larger images are scaled down to, in pixels")
        ->check(CLI::Range(16, 8192));
    command.add_flag("--linear", dataset.is_linear, "PNG and JPEG values are linear, not sRGB");
    command
        .add_option("--hold-out", dataset.hold_out,
                    "Hold out every n-th view for testing if the dataset has no split; 0: none")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command
        .add_option("--views", dataset.max_views,
                    "Number of views to train on, evenly spaced in the dataset")
        ->check(CLI::Range(3, 100000));
    command.add_option("--up", dataset.up, "Up axis of the dataset: x, y, z, -x, -y, -z or auto")
        ->type_name("AXIS")
        ->capture_default_str();
}

void add_several(CLI::Option* option) {
    option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_comparisons(CLI::App& command, ReconstructCommand& options) {
    add_several(command
                    .add_option("--relit", options.relit,
                                "Images of the test views in another light, for a comparison; "
                                "given once for each --relit-light")
                    ->type_name("FOLDER"));
    add_several(command
                    .add_option("--relit-light", options.relit_lights,
                                "Light of --relit: a preset or a file")
                    ->type_name("LIGHT"));
    add_several(command.add_option("--relit-exposure", options.relit_exposures,
                                   "Exposure of the images of --relit, in stops"));
    command
        .add_option("--truth", options.request.truth,
                    "Images of the true materials in the test views, for a comparison: "
                    "NAME_albedo.png, NAME_orm.png")
        ->type_name("FOLDER");
}

}  // namespace

void add_reconstruct_command(CLI::App& app) {
    auto options = std::make_shared<ReconstructCommand>();
    CLI::App* command = add_command(app, "reconstruct", *options);
    ReconstructRequest& request = options->request;
    CLI::Option* dataset = command->add_option(
        "DATASET", request.dataset,
        "Folder of a dataset: NeRF-synthetic, nerfstudio (transforms.json), COLMAP or LLFF");
    command
        ->add_option("--from-images", options->from_images,
                     "Photographs without poses; COLMAP estimates the poses (apt install colmap)")
        ->type_name("FOLDER")
        ->excludes(dataset);
    command
        ->add_option("-o,--output", request.output,
                     "Folder for the model, its light and the report")
        ->type_name("FOLDER")
        ->required();
    command->add_flag("--resume", request.resume,
                      "Continue from the checkpoint in the output folder");
    add_dataset_options(*command, *options);
    CLI::Option* mesh =
        command
            ->add_option("--mesh", request.mesh,
                         "Known mesh: only its materials and the light are reconstructed")
            ->type_name("FILE");
    command
        ->add_flag("--move-vertices", options->move_vertices, "Optimize the vertices of --mesh too")
        ->needs(mesh);
    command
        ->add_flag("--place-mesh", request.place_mesh,
                   "Rotate, scale and move --mesh to where the photographs show it")
        ->needs(mesh);
    command
        ->add_option("--extraction", request.shape.extraction,
                     "Method that extracts triangles from the values on the lattice")
        ->check(CLI::IsMember(extraction_names()))
        ->capture_default_str();
    command
        ->add_option("--cells", options->cells,
                     "Cells of the lattice along the longest side of the object")
        ->check(CLI::Range(16, 256))
        ->capture_default_str();
    command
        ->add_option("--shape-iterations", request.shape.iterations,
                     "Optimisation steps of the shape, one image each")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    command
        ->add_option("--iterations", request.refine.iterations,
                     "Optimisation steps of materials, light and vertices, one image each")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    command
        ->add_option("--triangles", request.shape.triangles,
                     "Maximum number of triangles of the model")
        ->check(CLI::Range(100, 10000000))
        ->capture_default_str();
    command
        ->add_option("--texture-size", request.texture_size,
                     "Edge length of the textures, in pixels. Default: 1024 to 4096, depending on "
                     "the size of the photographs")
        ->check(CLI::Range(16, 4096));
    command->add_flag("--no-normal-map", options->no_normal_map, "Write no normal map");
    command->add_flag("--no-shadows", options->no_shadows,
                      "Ignore the shadows that the object casts on itself");
    command
        ->add_option(
            "--poses", options->poses,
            "Correction of the cameras; auto: refine them if the outlines in the images disagree")
        ->check(CLI::IsMember({"auto", "refine", "keep"}))
        ->capture_default_str();
    command->add_flag("--keep-exposure", options->keep_exposure,
                      "All images have the same exposure and white balance");
    command
        ->add_option("--reference", request.reference, "True mesh, to measure the distance to it")
        ->type_name("FILE");
    add_comparisons(*command, *options);
    command
        ->add_option("--provenance", options->provenance,
                     "on: record in the XMP of model and textures that they were computed from "
                     "photographs (docs/provenance.md); off: do not")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str();
    add_sign_key(*command, options->sign_key);
    command->add_option("--seed", options->seed, "Seed of all random numbers")
        ->check(seed_check())
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        if (options->device == "cuda") {
            throw ResourceError("--device cuda: reconstruct computes on the CPU; use --device cpu");
        }
        run_reconstruct(*options);
    });
}

}  // namespace item3d
