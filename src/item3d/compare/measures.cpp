#include "item3d/compare/measures.h"

#include "item3d/baselines/painting_scene.h"
#include "item3d/baselines/view_lists.h"
#include "item3d/compare/baked_light.h"
#include "item3d/compare/view_difference.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/random.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/field/surface_points.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/render/pictures.h"
#include "item3d/render/rasterize.h"
#include "item3d/render/srgb.h"
#include "item3d/report/animation.h"
#include "item3d/report/model_pictures.h"
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
constexpr int view_count = 6;
constexpr int view_pixels = 256;
constexpr int depth_pixels = 512;
constexpr double whole_pixel = 0.999;  ///< coverage
constexpr double same_place = 1e-4;    ///< of the radius
constexpr int shown[] = {0, 3};        ///< of the views: front and back

/// The same points on a model, for each of the models that are compared.
Surface points_of(const Model& model, const Geometry& geometry) {
    std::vector<int> materials(model.materials.size());
    std::iota(materials.begin(), materials.end(), 0);
    const FieldSpace space(model, materials);
    Random random(0);
    return SurfaceSampler(geometry, space).sample(point_count, random);
}

bool same_geometry(const Geometry& a, const Geometry& b, double radius) {
    if (a.triangles.size(0) != b.triangles.size(0)) return false;
    // Vertices are split anew where UV maps or tangents are, so corners are compared.
    const auto corners = [](const Geometry& geometry) {
        return geometry.positions.index_select(0, geometry.triangles.flatten().to(at::kLong));
    };
    return (corners(a) - corners(b)).abs().max().item<double>() <= same_place * radius;
}

Image to_strip(const at::Tensor& pictures) {
    std::vector<at::Tensor> parts;
    for (const int index : shown)
        parts.push_back(pictures[index]);
    return to_image(at::cat(parts, 2).permute({1, 2, 0}).contiguous());
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

/// Of the pictures in views/ that controlnet-2d drew, pixels of the prior's size.
double painted_difference(const fs::path& folder, const Json& files, const Model& model,
                          const Surface& points, const Geometry& geometry, double radius) {
    PaintingScene scene;
    for (const Primitive& primitive : model.primitives)
        scene.points.insert(scene.points.end(), primitive.positions.begin(),
                            primitive.positions.end());
    std::vector<PointColors> views;
    for (std::size_t i = 0; i < std::min(files.size(), ring_and_poles().size()); ++i) {
        const Camera camera = side_view(scene, ring_and_poles()[i]).camera;
        const at::Tensor picture = to_tensor(load_image(folder / files[i].get<std::string>()))
                                       .narrow(2, 0, 3)
                                       .permute({2, 0, 1})
                                       .contiguous();
        const std::int64_t size = picture.size(2);
        const std::int64_t finer = std::max<std::int64_t>(1, depth_pixels / size);
        const auto pixels = static_cast<int>(size * finer);
        const Raster raster = rasterize(geometry, {camera}, pixels, pixels);
        const at::Tensor covered = (raster.triangle >= 0).to(at::kFloat);
        const at::Tensor counts =
            (covered.reshape({1, size, finer, size, finer}).mean({2, 4}) > whole_pixel)
                .to(at::kFloat);
        views.push_back(colors_of_points(points, camera, raster.depth[0], picture, counts, radius));
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

Json computed(const CompareRun& run, const CompareCase& test, const Json& summary) {
    const at::NoGradGuard no_grad;
    const LoadOptions load = load_options(test);
    const Model before = load_model(test.model, load);
    Model after = load_model(run.folder / model_file_name(test.model), load);
    move_origin(after, before.origin);
    const double radius = bounding_sphere(before).radius;
    const Geometry was = Geometry::from_model(before), is = Geometry::from_model(after);
    const bool kept = same_geometry(was, is, radius);
    Json result = {{"geometry_kept", kept}, {"uv_kept", kept && summary.at("new_uv_maps").empty()}};

    const std::string light_name = summary.at("settings").at("light").get<std::string>();
    const Image light = load_light(light_name);
    const EnvironmentLight shining = prefilter(light, light_texels(view_pixels));
    const auto cameras = picture_cameras(before, view_count);
    const at::Tensor drawn = draw_pictures(after, shining, cameras, view_pixels);
    write_atomically(run.folder / "view.webp", encode_webp(to_strip(over_white(drawn))));
    std::vector<Camera> shown_cameras;
    for (const int index : shown)
        shown_cameras.push_back(cameras[static_cast<std::size_t>(index)]);
    const at::Tensor drawn_before =
        over_white(draw_pictures(before, shining, shown_cameras, view_pixels));
    write_atomically(
        run.folder / "before.webp",
        encode_webp(to_image(
            at::cat({drawn_before[0], drawn_before[1]}, 2).permute({1, 2, 0}).contiguous())));

    const Surface points = points_of(after, is);
    const Json pictures = summary.value("views", Json::array());
    const double apart = run.method == "controlnet-2d" && !pictures.empty()
                             ? painted_difference(run.folder, pictures, before, points, is, radius)
                             : drawn_difference(points, is, cameras, drawn, radius);
    if (std::isfinite(apart)) result["view_difference"] = apart;
    if (kept) {
        const Surface source = points_of(before, was);
        const at::Tensor moved = (source.position - points.position).abs().max();
        if (moved.item<double>() <= same_place * radius)
            result["light_baked"] = baked_light(TexturedMaterials(before).sample(source).base_color,
                                                TexturedMaterials(after).sample(points).base_color,
                                                source.normal, light);
    }
    return result;
}

}  // namespace

Json row_of(const CompareRun& run, const CompareCase& test) {
    return {{"case", test.name},    {"model", test.model.filename().string()},
            {"from", test.from},    {"to", test.to},
            {"method", run.method}, {"prior", run.prior},
            {"seed", run.seed},     {"folder", "runs/" + run.folder.filename().string()}};
}

Json measured_run(const CompareRun& run, const CompareCase& test) {
    Json row = row_of(run, test);
    if (!is_done(run)) {
        const std::string error = error_of(run);
        row["error"] = error.empty() ? "was not run" : error;
        return row;
    }
    const Json summary = Json::parse(read_text(run.folder / "edit.json"), nullptr, false);
    if (!summary.is_object() || !summary.contains("scores")) {
        row["error"] = "edit.json cannot be read; remove the run's folder to run it again";
        return row;
    }
    const fs::path kept = run.folder / "measures.json";
    Json measures = fs::exists(kept) ? Json::parse(read_text(kept), nullptr, false) : Json();
    if (!measures.is_object()) {
        measures = computed(run, test, summary);
        write_atomically(kept, measures.dump(2) + "\n");
    }
    row.update(measures);
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
