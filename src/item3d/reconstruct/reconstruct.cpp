#include "item3d/reconstruct/reconstruct.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/reconstruct/dataset/check_frame.h"
#include "item3d/reconstruct/dataset/check_views.h"
#include "item3d/reconstruct/dataset/photograph.h"
#include "item3d/reconstruct/outputs/outputs.h"
#include "item3d/reconstruct/outputs/reconstruction_claim.h"
#include "item3d/reconstruct/outputs/report.h"
#include "item3d/reconstruct/shape/align_poses.h"
#include "item3d/reconstruct/stage_runner.h"
#include "item3d/reconstruct/surface/light_scale.h"
#include "item3d/reconstruct/surface/plain_model.h"
#include "item3d/scene/far_origin.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>

namespace item3d {

namespace {

constexpr std::size_t train_views_scored = 6;
/// Maximum disagreement of outlines in pixels. Poses that are half a degree off exceed it.
constexpr double max_disagreement = 0.15;

std::string describe(const Dataset& dataset) {
    const Image& first = dataset.train.front().image;
    return fmt::format("{}: {} training views, {} held out, {} x {}, masks from {}",
                       dataset_kind_name(dataset.kind), dataset.train.size(), dataset.test.size(),
                       first.width, first.height, dataset.masks);
}

/// Returns the test views for which the folder has an image, with that image.
std::vector<Photograph> relit_views(const Dataset& dataset, const ReconstructRequest& request,
                                    const RelitViews& relit) {
    std::vector<Photograph> views;
    for (Photograph view : dataset.test) {
        SourceView source;
        source.name = view.name;
        source.image = find_image(relit.folder / std::filesystem::path(view.name).filename());
        if (!std::filesystem::is_regular_file(source.image)) continue;
        source.lens.focal_x = source.lens.focal_y = 1;
        const Image image = load_photograph(source, {}, request.dataset_options).image;
        if (image.width != view.image.width || image.height != view.image.height) {
            throw InputError(source.image.string(), "does not have the size of its test view",
                             "give images of the same size");
        }
        // Replaces the coverage in the premultiplied colours by that of the test view.
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < 3; ++c)
                    view.image.at(x, y, c) =
                        std::min(1.0f,
                                 view.image.at(x, y, 3) / std::max(image.at(x, y, 3), 1e-6f)) *
                        image.at(x, y, c);
        views.push_back(std::move(view));
    }
    if (views.empty()) {
        throw InputError(relit.folder.string(), "contains no image with the name of a test view",
                         "name the images like the views of the test set");
    }
    return views;
}

void leave_out(Dataset& dataset, std::vector<std::size_t> views) {
    std::sort(views.rbegin(), views.rend());
    for (const std::size_t i : views)
        dataset.train.erase(dataset.train.begin() + static_cast<std::ptrdiff_t>(i));
}

/// Adds a warning; "" adds none.
void add_warning(Reconstruction& result, const std::string& text) {
    if (text.empty()) return;
    result.warnings.push_back(text);
    warn(text);
}

void choose_texture_size(Reconstruction& result, const Model& model, float pixel) {
    result.texture_size = result.request.texture_size > 0 ? result.request.texture_size
                                                          : texture_size_for(model, pixel);
}

void note_blurred_views(Reconstruction& result, const ViewCorrections& corrections) {
    const auto blurred = corrections.blurred();
    if (blurred.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, blurred.size()); ++i)
        names += (i > 0 ? ", " : "") + result.dataset.train[blurred[i]].name;
    add_warning(
        result,
        fmt::format(
            "{} of {} images are less sharp than their neighbours and get a lower weight: {}{}",
            blurred.size(), result.dataset.train.size(), names, blurred.size() > 3 ? ", ..." : ""));
}

void note_exposures(const std::vector<Photograph>& views) {
    double minimum = std::numeric_limits<double>::max(), greatest = 0;
    for (const Photograph& view : views) {
        minimum = std::min(minimum, view.exposure);
        greatest = std::max(greatest, view.exposure);
    }
    if (minimum > 0 && greatest > 1.01 * minimum)
        note(
            fmt::format("exposures differ by a factor of {:.2f} (EXIF); the gains start with these",
                        greatest / minimum));
}

/// Throws InputError if a folder or a light of the final comparison cannot be read.
void check_comparisons(const ReconstructRequest& request) {
    const auto require_folder = [](const std::filesystem::path& folder, const char* images) {
        std::error_code code;
        if (!std::filesystem::is_directory(folder, code))
            throw InputError(folder.string(), "no such folder",
                             std::string("give the folder of ") + images);
    };
    for (const RelitViews& views : request.relit) {
        require_folder(views.folder, "the images of the test views in the other light");
        load_light(views.light);
    }
    if (!request.truth.empty()) require_folder(request.truth, "NAME_albedo.png and NAME_orm.png");
}

/// Returns the mesh of --reference; nullopt without this option. It is read before the long stages.
std::optional<TriangleMesh> read_reference(const ReconstructRequest& request) {
    if (request.reference.empty()) return std::nullopt;
    Model reference = load_model(request.reference);
    move_origin(reference, glm::dvec3(0.0));
    return mesh_of(reference);
}

void score(Reconstruction& result, const ViewCorrections& corrections,
           const std::optional<TriangleMesh>& reference) {
    const ReconstructRequest& request = result.request;
    const std::int64_t shadow_points = request.refine.shadows ? request.refine.shadow_points : 0;
    const ModelRenderer renderer(result.model, result.light, shadow_points);
    const std::vector<Photograph>& test = result.dataset.test;
    if (request.corrections.exposure) {
        ModelRenderer::BothScores both = renderer.score_both(test);
        result.test = std::move(both.as_it_is);
        result.test_scaled = std::move(both.each_scaled);
    } else {
        result.test = renderer.score(test);
    }
    result.train =
        renderer.score(some_views(corrections.corrected(result.dataset.train), train_views_scored));
    if (corrections.refines_poses() && !test.empty()) {
        const Dataset& dataset = result.dataset;
        const auto by_outlines = aligned_to_mesh(mesh_of(result.model), dataset, test);
        result.test_aligned =
            renderer.score_both(renderer.aligned(by_outlines, dataset.centre, dataset.radius))
                .each_scaled;
    }
    result.test_without_shadows = ModelRenderer(result.model, result.light, 0).score(test);
    for (const RelitViews& views : request.relit) {
        const auto targets = relit_views(result.dataset, request, views);
        const ModelRenderer relit(
            result.model, adjust_light(load_light(views.light), 0, views.exposure), shadow_points);
        const Vec3 gain = relit.best_gain(targets);
        result.relit.push_back({relit.score(targets), relit.score(targets, gain), gain});
    }
    if (!request.truth.empty())
        result.materials = compare_materials(
            result.model, make_targets(test, result.model.bounds()), request.truth);
    if (reference) result.chamfer = chamfer_distance(mesh_of(result.model), *reference);
}

/// Moves the model to where the photographs show it.
void place(Model& model, Reconstruction& result) {
    const Placement placement =
        place_mesh(mesh_of(model), result.dataset, result.request.mesh.string());
    if (placement.words.empty()) return;
    note(fmt::format("the mesh is {}; its outlines overlap the masks by {:.1f} %", placement.words,
                     100 * placement.overlap));
    const Mat4 matrix = placement.matrix();
    for (Primitive& primitive : model.primitives) {
        for (Vec3& position : primitive.positions)
            position = Vec3(matrix * Vec4(position, 1));
        for (Vec3& normal : primitive.normals)
            normal = placement.turn * normal;
    }
    result.mesh_placed = matrix;
}

/// Mesh with UVs, and the materials and light from which the refinement starts.
struct Start {
    Model model;
    Appearance appearance;
};

Start start_from_mesh(const ReconstructRequest& request, Reconstruction& result) {
    const Dataset& dataset = result.dataset;
    Model plain = load_plain_model(request.mesh);
    if (request.place_mesh) place(plain, result);
    add_warning(result, check_mesh_frame(mesh_of(plain), dataset, request.mesh.string()));
    const auto bounds = plain.bounds();
    const auto views = make_targets({dataset.train.front()}, bounds);
    choose_texture_size(result, plain, pixel_size(bounds, views.front()));
    Model model = unwrapped(std::move(plain), result.texture_size);
    return {std::move(model),
            make_appearance(bounds, views, AppearanceStart::smooth, request.refine.seed)};
}

Start start_from_photographs(const ReconstructRequest& request, Reconstruction& result,
                             ViewCorrections& corrections, StageRunner& runner) {
    const Dataset& dataset = result.dataset;
    const double disagreement = align_to_hull(dataset, request.dataset.string(), corrections);
    const VisualHull hull(corrections.corrected(dataset.train));
    const auto bounds = hull.bounds(dataset.centre, dataset.radius, request.dataset.string());
    const auto appearance_from = [&](AppearanceStart start) {
        return make_appearance(bounds, make_targets({dataset.train.front()}, bounds), start,
                               request.refine.seed);
    };
    result.shape = runner.found_shape();
    if (!result.shape) {
        Appearance appearance = appearance_from(AppearanceStart::matt);
        ShapeSearch search(dataset, hull, bounds, appearance, corrections, request.shape);
        runner.run(search);
        result.shape = search.shape();
        result.shape->outline_disagreement = disagreement;
    }
    runner.keep(*result.shape);
    if (result.shape->outline_disagreement > max_disagreement) {
        add_warning(
            result,
            fmt::format(
                "the outlines in the images disagree by {:.1f} pixels; check poses and masks",
                result.shape->outline_disagreement));
    }
    const TriangleMesh& mesh = result.shape->mesh;
    result.times.end_stage("shape");
    Model plain = plain_model(mesh.positions, mesh.triangles);
    choose_texture_size(result, plain,
                        pixel_size(bounds, make_targets({dataset.train.front()}, bounds).front()));
    return {unwrapped(std::move(plain), result.texture_size),
            appearance_from(AppearanceStart::smooth)};
}

}  // namespace

nlohmann::json reconstruct(const ReconstructRequest& request) {
    const OutputFolder folder(request.output);
    if (!request.resume && std::filesystem::exists(request.output / "model.glb"))
        note((request.output / "model.glb").string() + " will be replaced at the end of this run");
    const std::optional<TriangleMesh> reference = read_reference(request);
    check_comparisons(request);
    StageTimes times;
    Dataset dataset = load_dataset(request.dataset, request.dataset_options);
    note(describe(dataset));
    const ViewProblems problems = check_views(dataset, request.dataset.string());
    leave_out(dataset, problems.contradicting);
    Reconstruction result(request, dataset, times);
    for (const std::string& warning : problems.warnings)
        add_warning(result, warning);
    result.times.end_stage("load");

    StageRunner runner(request, dataset);
    // The provenance is read before the long stages, because the images may be gone after them.
    const Provenance provenance = provenance_of(request, dataset, runner.begun());
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, request.corrections);
    note_blurred_views(result, corrections);
    if (request.corrections.exposure) note_exposures(dataset.train);
    Start start = request.mesh.empty()
                      ? start_from_photographs(request, result, corrections, runner)
                      : start_from_mesh(request, result);
    result.times.end_stage("unwrap");

    MovableMesh mesh(start.model, request.move_vertices);
    Refinement refinement(start.appearance, corrections, mesh, start.model,
                          make_targets(dataset.train, start.model.bounds()), request.refine);
    runner.run(refinement);
    result.refine = refinement.curves();
    balance_base_color(start.appearance.field, start.appearance.light);
    result.times.end_stage("refine");

    result.model = bake_and_save(request.output / "model.glb", mesh.apply(start.model),
                                 start.appearance, request, result.texture_size, provenance);
    result.light = start.appearance.light.to_image();
    save_image(request.output / "light.hdr", result.light, 32);
    result.times.end_stage("bake");

    result.corrections = corrections_json(dataset, corrections);
    score(result, corrections, reference);
    result.times.end_stage("scores");
    const nlohmann::json summary = summary_json(result);
    write_atomically(request.output / "report.html", std::string_view(report_html(result)));
    write_atomically(request.output / "reconstruct.json", std::string_view(summary.dump(2) + "\n"));
    return summary;
}

}  // namespace item3d
