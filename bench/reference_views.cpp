// Comparison of renders of a textured model with path tracing in eight views: visibility and
// radiance.
#include "bench/reference_report.h"
#include "bench/reference_split_sum.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/render.h"
#include "item3d/render/scatter.h"
#include "item3d/render/textured_materials.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace item3d::reference {
namespace {

constexpr int view_size = 256;

struct Views {
    Model model;
    Geometry geometry;
    std::vector<Camera> cameras;
    std::filesystem::path folder;
    std::filesystem::path file(int view, const std::string& what) const {
        return folder / fmt::format("view_{:02}_{}", view, what);
    }
};

Views load_views(const Folders& folders) {
    Views views;
    views.folder = folders.data / "views_spot_sky_noon";
    views.model = load_model(folders.data / "meshes" / "spot" / "spot.obj");
    for (Primitive& primitive : views.model.primitives)
        compute_smooth_normals(primitive);  // the references do not use the file's normals
    views.geometry = Geometry::from_model(views.model);
    const auto scene = nlohmann::json::parse(read_text(views.folder / "scene.json"));
    for (const auto& frame : scene["frames"]) {
        Camera camera;
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                camera.camera_to_world[column][row] =
                    frame["camera_to_world_opengl"][static_cast<std::size_t>(row)]
                         [static_cast<std::size_t>(column)];
        camera.field_of_view_x = scene["fov_x_deg"].get<float>() * pi / 180;
        views.cameras.push_back(camera);
    }
    for (Material& material : views.model.materials) {
        material.metallic_factor = scene["metallic"];
        material.roughness_factor = scene["roughness"];
        material.metallic_roughness_texture = material.occlusion_texture = -1;
    }
    return views;
}

/// Returns the mask [H, W] of the pixels whose eight neighbours all have the same value in `mask`.
at::Tensor away_from_edges(const at::Tensor& mask) {
    const at::Tensor m = mask.to(at::kFloat).reshape({1, 1, view_size, view_size});
    const at::Tensor maximum = at::max_pool2d(m, 3, 1, 1);
    const at::Tensor minimum = -at::max_pool2d(-m, 3, 1, 1);
    return (maximum == minimum).reshape({view_size, view_size});
}

/// Exact split sum at the centre of every 29th chosen pixel, times the share of the light that
/// reaches the surface point there.
struct SplitSumSample {
    at::Tensor radiance;  ///< [P, 3]
    at::Tensor pixel;     ///< [P] indices of the pixels in the image
};
SplitSumSample split_sum_sample(const Views& views, const Camera& camera, const at::Tensor& chosen,
                                const Occlusion& occlusion, const ExactSplitSum& split_sum) {
    constexpr std::int64_t every = 29;
    const Raster raster = rasterize(views.geometry, {camera}, view_size, view_size);
    const Surface surface = interpolate_surface(views.geometry, raster, {camera});
    const MaterialSample material = TexturedMaterials(views.model).sample(surface);
    const at::Tensor arriving = occlusion.at(raster, surface);
    const at::Tensor rows = chosen.flatten()
                                .index_select(0, surface.pixel)
                                .nonzero()
                                .flatten()
                                .slice(0, 0, std::nullopt, every);
    const auto vectors = [&](const at::Tensor& tensor) {
        const at::Tensor some = tensor.index_select(0, rows).contiguous();
        const auto* values = some.const_data_ptr<float>();
        std::vector<Vec3> list;
        for (std::int64_t i = 0; i < some.size(0); ++i)
            list.emplace_back(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
        return list;
    };
    const Material& constants = views.model.materials.front();
    const at::Tensor radiance = split_sum.radiance(
        vectors(surface.normal), vectors(surface.view), vectors(material.base_color),
        constants.metallic_factor, constants.roughness_factor);
    return {radiance * arriving.index_select(0, rows).unsqueeze(1),
            surface.pixel.index_select(0, rows)};
}

}  // namespace

Section geometry_section(const Folders& folders) {
    const Views views = load_views(folders);
    Section section;
    section.title = "Visibility";
    section.text =
        "Eight views of the model spot.\n\n"
        "- **Mask**: number of pixels whose centre shows the model in one of the two renders "
        "only.\n"
        "- **Depth and normal**, where both show the model: the largest relative difference of "
        "depth, and the angle between normals.\n"
        "- **Coverage**: antialiased coverage with 1, 2 x 2, 4 x 4 and 8 x 8 samples per pixel, "
        "compared with the reference's of 512 samples. Each cell has the largest difference and "
        "the share of edge pixels within 1/16.";
    section.columns = {"view",
                       "mask differs at",
                       "depth, largest",
                       "normal, 99 %",
                       "normal, largest",
                       "coverage, 1 sample",
                       "coverage, 2 x 2",
                       "coverage, 4 x 4",
                       "coverage, 8 x 8"};
    const EnvironmentLight light = prefilter(at::ones({6, 16, 16, 3}));
    for (std::size_t v = 0; v < views.cameras.size(); ++v) {
        const int view = static_cast<int>(v);
        const std::vector<Camera> camera{views.cameras[v]};
        const Raster raster = rasterize(views.geometry, camera, view_size, view_size);
        const Surface surface = interpolate_surface(views.geometry, raster, camera);
        const at::Tensor seen = raster.triangle[0] >= 0;
        const at::Tensor mask = load_reference(views.file(view, "mask.png")).select(2, 0) > 0.5f;
        const at::Tensor both = seen.logical_and(mask);
        const at::Tensor depth = load_reference(views.file(view, "depth.exr")).select(2, 0);
        const double depth_error = ((raster.depth[0] - depth).abs() / depth.clamp_min(1e-6f))
                                       .masked_select(both)
                                       .max()
                                       .item<double>();
        const at::Tensor normals = scatter(surface.normal, surface, raster, at::zeros({3}))[0];
        const at::Tensor expected = load_reference(views.file(view, "normal.exr")).narrow(2, 0, 3);
        const at::Tensor angle =
            at::atan2(at::linalg_cross(normals, expected).norm(2, 2), (normals * expected).sum(2))
                .masked_select(both) *
            (180 / pi);
        const double angle_99 =
            std::get<0>(
                angle.sort())[static_cast<std::int64_t>(0.99 * static_cast<double>(angle.numel()))]
                .item<double>();

        const at::Tensor coverage = load_reference(views.file(view, "lambertggx.exr")).select(2, 3);
        const at::Tensor edge = ((coverage > 0.001f).logical_and(coverage < 0.999f));
        std::vector<std::string> cells;
        nlohmann::json by_samples;
        for (const int samples : {1, 2, 4, 8}) {
            RenderOptions options;
            options.width = options.height = view_size;
            options.supersampling = samples;
            const at::Tensor alpha =
                render(views.geometry, TexturedMaterials(views.model), light, camera, options)[0]
                    .select(2, 3);
            const at::Tensor error = (alpha - coverage).abs();
            const double largest = error.max().item<double>();
            const double within =
                (error.masked_select(edge) <= 1.0f / 16).to(at::kFloat).mean().item<double>();
            cells.push_back(fmt::format("{:.3f}, {:.1f} %", largest, 100 * within));
            by_samples[std::to_string(samples)] = {{"largest", largest},
                                                   {"within_sixteenth", within}};
        }
        const auto differs = (seen != mask).sum().item<std::int64_t>();
        section.rows.push_back({std::to_string(view),
                                fmt::format("{} of {}", differs, mask.sum().item<std::int64_t>()),
                                fmt::format("{:.1e}", depth_error),
                                fmt::format("{:.2f}°", angle_99),
                                fmt::format("{:.2f}°", angle.max().item<double>()), cells[0],
                                cells[1], cells[2], cells[3]});
        section.numbers[fmt::format("view_{:02}", view)] = {
            {"mask_differs", differs},
            {"depth", depth_error},
            {"normal_degrees_99", angle_99},
            {"normal_degrees", angle.max().item<double>()},
            {"coverage_by_samples", by_samples}};
    }
    return section;
}

Section view_section(const Folders& folders) {
    const Views views = load_views(folders);
    const Image map = load_image(folders.data / "env" / "sky_noon.hdr");
    const EnvironmentLight light = prefilter(map);
    Section section;
    section.title = "A textured model";
    section.text =
        "The scene is spot under sky_noon with roughness 0.4. Pixels at silhouettes do not count. "
        "A difference is the mean absolute difference divided by the mean. The reference contains "
        "the shadows that the model casts on itself; our render contains them only with "
        "`--occlusion`.\n\n"
        "| column | render |\n|---|---|\n"
        "| *no occlusion* | ours without `--occlusion` |\n"
        "| *ambient* | ours with `--occlusion` |\n"
        "| *of this light* | ours with `--occlusion=light` |\n"
        "| *energy* | our sum over the reference's, with `--occlusion=light` |\n"
        "| *split sum* | the approximation itself, summed over every texel, times the same share "
        "of the light, at every 29th pixel |\n"
        "| *ours there* | ours with `--occlusion=light`, at the same pixels |\n"
        "| *of this light, to Disney's* | ours with `--occlusion=light`, compared with Disney's "
        "reflectance |\n"
        "| *models* | Disney's reflectance compared with the reference |\n\n";
    section.columns = {"view",   "no occlusion", "ambient",    "of this light",
                       "energy", "split sum",    "ours there", "of this light, to Disney's",
                       "models"};
    OcclusionOptions of_light;
    of_light.light = map;
    const std::array<std::shared_ptr<const Occlusion>, 3> occlusions = {
        nullptr, std::make_shared<Occlusion>(views.geometry),
        std::make_shared<Occlusion>(views.geometry, nullptr, of_light)};
    const ExactSplitSum split_sum(map, 1);
    std::vector<std::vector<at::Tensor>> tiles(4);
    std::array<double, 3> means{};
    constexpr std::array<int, 4> shown = {0, 2, 4, 7};  // including the best and the worst view
    for (std::size_t v = 0; v < views.cameras.size(); ++v) {
        const int view = static_cast<int>(v);
        std::array<at::Tensor, 3> images;
        for (std::size_t i = 0; i < images.size(); ++i) {
            RenderOptions options;
            options.width = options.height = view_size;
            options.shade.multiple_scattering = false;
            options.occlusion = occlusions[i];
            images[i] = render(views.geometry, TexturedMaterials(views.model), light,
                               {views.cameras[v]}, options)[0];
        }
        const at::Tensor traced = load_reference(views.file(view, "lambertggx.exr"));
        const at::Tensor disney = load_reference(views.file(view, "principled.exr"));
        const at::Tensor mask = load_reference(views.file(view, "mask.png")).select(2, 0) > 0.5f;
        const at::Tensor inside = mask.logical_and(away_from_edges(mask));
        const auto at = [&](const at::Tensor& image, const at::Tensor& pixels) {
            return image.reshape({view_size * view_size, -1})
                .index_select(0, pixels)
                .narrow(1, 0, 3);
        };
        const auto chosen = [&, pixels = inside.flatten().nonzero().flatten()](
                                const at::Tensor& image) { return at(image, pixels); };
        std::array<Difference, 3> ours{};
        for (std::size_t i = 0; i < ours.size(); ++i) {
            ours[i] = difference(chosen(images[i]), chosen(traced));
            means[i] += ours[i].mean / static_cast<double>(views.cameras.size());
        }
        const SplitSumSample exact =
            split_sum_sample(views, views.cameras[v], inside, *occlusions.back(), split_sum);
        const at::Tensor traced_there = at(traced, exact.pixel);
        const Difference approximation = difference(exact.radiance, traced_there);
        const Difference ours_there = difference(at(images[2], exact.pixel), traced_there);
        const Difference to_disney = difference(chosen(images[2]), chosen(disney));
        const Difference models = difference(chosen(disney), chosen(traced));
        const auto percent = [](double part) { return fmt::format("{:.1f} %", 100 * part); };
        section.rows.push_back({std::to_string(view), percent(ours[0].mean), percent(ours[1].mean),
                                percent(ours[2].mean), fmt::format("{:.3f}", ours[2].bias),
                                percent(approximation.mean), percent(ours_there.mean),
                                percent(to_disney.mean), percent(models.mean)});
        section.numbers[fmt::format("view_{:02}", view)] = {
            {"no_occlusion", ours[0].mean},
            {"ambient", ours[1].mean},
            {"of_light", ours[2].mean},
            {"split_sum", approximation.mean},
            {"ours_there", ours_there.mean},
            {"energy_no_occlusion", ours[0].bias},
            {"energy_of_light", ours[2].bias},
            {"of_light_to_principled", to_disney.mean},
            {"models", models.mean}};
        if (std::ranges::find(shown, view) == shown.end()) continue;
        const auto color = [](const at::Tensor& image) { return image.narrow(2, 0, 3); };
        tiles[0].push_back(color(traced));
        tiles[1].push_back(color(images[0]));
        tiles[2].push_back(color(images[2]));
        tiles[3].push_back((color(traced) - color(images[2])).abs() * 4);
    }
    section.rows.push_back({"mean", fmt::format("{:.1f} %", 100 * means[0]),
                            fmt::format("{:.1f} %", 100 * means[1]),
                            fmt::format("{:.1f} %", 100 * means[2]), "", "", "", "", ""});
    save_tiles(folders.output / "views.png", tiles);
    section.images = {"views.png"};
    section.text +=
        "The image shows the path-traced render, ours without occlusion, ours with "
        "`--occlusion=light`, and four times the difference of the last, for views 0, 2, 4 and 7.";
    return section;
}

}  // namespace item3d::reference
