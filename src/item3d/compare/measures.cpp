#include "item3d/compare/measures.h"

#include "item3d/baselines/painting_scene.h"
#include "item3d/baselines/view_lists.h"
#include "item3d/compare/baked_light.h"
#include "item3d/compare/run_images.h"
#include "item3d/compare/verdict.h"
#include "item3d/compare/view_difference.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/random.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/rasterize.h"
#include "item3d/render/srgb.h"
#include "item3d/report/model_images.h"
#include "item3d/scene/bounding_sphere.h"
#include "item3d/scene/far_origin.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int point_count = 4000;
constexpr int depth_pixels = 512;
constexpr double whole_pixel = 0.999;  ///< minimum coverage
constexpr double same_place = 1e-4;    ///< tolerance, relative to the radius

/// Returns the same points on each of the compared models.
Surface points_of(const Model& model, const Geometry& geometry) {
    std::vector<int> materials(model.materials.size());
    std::iota(materials.begin(), materials.end(), 0);
    const FieldSpace space(model, materials);
    Random random(0);
    return SurfaceSampler(geometry, space).sample(point_count, random);
}

bool same_geometry(const Geometry& a, const Geometry& b, double radius) {
    if (a.triangles.size(0) != b.triangles.size(0)) return false;
    // Vertices are split differently at UV seams and tangents, so corners are compared.
    const auto corners = [](const Geometry& geometry) {
        return geometry.positions.index_select(0, geometry.triangles.flatten().to(at::kLong));
    };
    return (corners(a) - corners(b)).abs().max().item<double>() <= same_place * radius;
}

bool has_uv_maps(const Model& model) {
    return std::any_of(model.primitives.begin(), model.primitives.end(),
                       [](const Primitive& primitive) { return !primitive.uvs.empty(); });
}

double drawn_difference(const Surface& points, const Geometry& geometry,
                        const std::vector<Camera>& cameras, const at::Tensor& linear,
                        double radius) {
    std::vector<PointColors> views;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto index = static_cast<std::int64_t>(i);
        const Raster raster = rasterize(geometry, {cameras[i]}, depth_pixels, depth_pixels);
        const at::Tensor counts =
            (linear[index].select(2, 3) > whole_pixel).to(at::kFloat).unsqueeze(0);
        views.push_back(colors_of_points(points, cameras[i], raster.depth[0],
                                         over_white(linear.narrow(0, index, 1))[0], counts,
                                         radius));
    }
    return view_difference(views);
}

/// Returns view_difference() of the images that controlnet-2d drew, which lie in views/ and have
/// the prior's size.
double painted_difference(const fs::path& folder, const std::vector<std::string>& files,
                          const Model& model, const Surface& points, const Geometry& geometry,
                          double radius) {
    PaintingScene scene;
    for (const Primitive& primitive : model.primitives)
        scene.points.insert(scene.points.end(), primitive.positions.begin(),
                            primitive.positions.end());
    std::vector<PointColors> views;
    for (std::size_t i = 0; i < std::min(files.size(), ring_and_poles().size()); ++i) {
        const Camera camera = side_view(scene, ring_and_poles()[i]).camera;
        const at::Tensor image = to_tensor(load_image(folder / files[i]))
                                     .narrow(2, 0, 3)
                                     .permute({2, 0, 1})
                                     .contiguous();
        const std::int64_t size = image.size(2);
        const std::int64_t finer = std::max<std::int64_t>(1, depth_pixels / size);
        const auto pixels = static_cast<int>(size * finer);
        const Raster raster = rasterize(geometry, {camera}, pixels, pixels);
        const at::Tensor covered = (raster.triangle >= 0).to(at::kFloat);
        const at::Tensor counts =
            (covered.reshape({1, size, finer, size, finer}).mean({2, 4}) > whole_pixel)
                .to(at::kFloat);
        views.push_back(colors_of_points(points, camera, raster.depth[0], image, counts, radius));
    }
    return view_difference(views);
}

LoadOptions load_options(const CompareCase& test) {
    LoadOptions options;
    const Json folders = test.options.value("textures", Json::array());
    for (const Json& folder : folders.is_array() ? folders : Json::array({folders}))
        options.texture_folders.emplace_back(folder.get<std::string>());
    options.variant = test.options.value("variant", "");
    return options;
}

/// Returns the options on which measures.json depends. If they change, the measures are computed
/// again.
Json asked_of(const CompareCase& test, const ImageWishes& wishes) {
    return {{"lights", wishes.lights}, {"all_views", wishes.all_views}, {"expect", test.expect}};
}

Json computed(const CompareRun& run, const CompareCase& test, const ImageWishes& wishes,
              const Json& summary) {
    const at::NoGradGuard no_grad;
    const LoadOptions load = load_options(test);
    RunModels models;
    models.before = load_model(test.model, load);
    models.after = load_model(run.folder / model_file_name(test.model), load);
    move_origin(models.after, models.before.origin);
    const Model &before = models.before, &after = models.after;
    const double radius = bounding_sphere(before).radius;
    const Geometry was = Geometry::from_model(before), is = Geometry::from_model(after);
    const bool kept = same_geometry(was, is, radius);
    Json result = {{"geometry_kept", kept}};
    if (has_uv_maps(before)) result["uv_kept"] = kept && summary.at("new_uv_maps").empty();

    models.light_before = load_light(summary.at("settings").at("light").get<std::string>());
    const fs::path found_light = run.folder / "light.exr";
    models.light_after =
        fs::exists(found_light) ? load_light(found_light.string()) : models.light_before;
    const auto cameras = image_cameras(before, run_view_count);
    const at::Tensor drawn =
        draw_images(after, prefilter(models.light_after, light_texels(run_view_pixels)), cameras,
                    run_view_pixels);
    std::vector<std::string> painted;
    if (run.edit_method == "controlnet-2d") painted = summary.value("views", painted);
    write_run_images(run, models, cameras, over_white(drawn), painted, wishes);
    result.update(
        verdict_of(test, summary["scores"].at("after"), over_white(drawn), run.prior_folder));

    const Surface points = points_of(after, is);
    const double apart = painted.empty()
                             ? drawn_difference(points, is, cameras, drawn, radius)
                             : painted_difference(run.folder, painted, before, points, is, radius);
    if (std::isfinite(apart)) result["view_difference"] = apart;
    if (kept) {
        const Surface source = points_of(before, was);
        const at::Tensor moved = (source.position - points.position).abs().max();
        if (moved.item<double>() <= same_place * radius)
            result["light_baked"] = baked_light(TexturedMaterials(before).sample(source).base_color,
                                                TexturedMaterials(after).sample(points).base_color,
                                                source.normal, models.light_before);
    }
    return result;
}

}  // namespace

Json row_of(const CompareRun& run, const CompareCase& test) {
    return {{"case", test.name},
            {"model", test.given_model.empty() ? test.model.filename().string() : test.given_model},
            {"from", test.from},
            {"to", test.to},
            {"method", run.method},
            {"prior", run.prior},
            {"seed", run.seed},
            {"expect", test.expect},
            {"options", test.options},
            {"folder", "runs/" + run.folder.filename().string()}};
}

Json measured_run(const CompareRun& run, const CompareCase& test, const ImageWishes& wishes) {
    Json row = row_of(run, test);
    if (!is_done(run)) {
        const std::string error = error_of(run);
        row["error"] = error.empty() ? "was not run" : error;
        return row;
    }
    const Json summary = parse_json(read_text(run.folder / "edit.json"));
    if (!summary.is_object() || !summary.contains("scores")) {
        row["error"] = "edit.json cannot be read; delete the run's folder to run it again";
        return row;
    }
    const fs::path kept = run.folder / "measures.json";
    Json measures = fs::exists(kept) ? parse_json(read_text(kept)) : Json();
    const Json asked = asked_of(test, wishes);
    if (!measures.is_object() || measures.value("asked", Json()) != asked) {
        measures = computed(run, test, wishes, summary);
        measures["asked"] = asked;
        write_atomically(kept, measures.dump(2) + "\n");
    }
    measures.erase("asked");
    row.update(measures);
    row["pictures"] = images_of_run(wishes, false);
    row["pictures_before"] = images_of_run(wishes, true);
    const Json& scores = summary["scores"];
    row["detail_kept"] = scores.at("detail_kept");
    if (!was_resumed(run)) {
        row["seconds"] = summary.at("seconds").at("total");
        row["peak_memory_bytes"] = summary.at("peak_memory_bytes");
    }
    row["unet_rows"] = summary.at("unet_rows");
    if (scores.contains("clip")) {
        row["clip_global"] = scores["clip"].at("global");
        row["clip_before"] = scores["clip"].at("global_before");
        row["clip_directional"] = scores["clip"].at("directional");
    }
    return row;
}

}  // namespace item3d
