// Comparison of dielectric and metal spheres of several roughnesses with path tracing. The
// difference has three causes, which are measured separately: the split-sum approximation itself
// (summed over every texel of the map), the choice of the reflectance model, and the renderer's
// prefiltered levels.
#include "bench/reference_report.h"
#include "bench/reference_split_sum.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/render.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/sphere.h"

#include <array>
#include <cmath>

namespace item3d::reference {
namespace {

const Vec3 base_color(0.8f, 0.45f, 0.2f);
constexpr int sphere_size = 256;
constexpr int stride = 10;  ///< distance between the pixels whose split sum is computed exactly

struct PixelList {
    std::vector<std::int64_t> pixel;
    std::vector<Vec3> normal, view;
};

PixelList inner_pixels(const at::Tensor& mask, const Camera& camera, int step) {
    PixelList list;
    const float tangent = std::tan(0.5f * camera.field_of_view_x);
    const Vec3 eye = camera.position();
    for (int y = step / 2; y < sphere_size; y += step) {
        for (int x = step / 2; x < sphere_size; x += step) {
            if (mask[y][x].item<float>() < 0.999f) continue;
            const Vec3 ray = glm::normalize(
                Vec3(tangent * (2 * (static_cast<float>(x) + 0.5f) / sphere_size - 1),
                     tangent * (1 - 2 * (static_cast<float>(y) + 0.5f) / sphere_size), -1.0f));
            const float along = -glm::dot(eye, ray);
            const float inside = along * along - glm::dot(eye, eye) + 1;
            if (inside < 0.01f) continue;  // too close to the sphere's silhouette
            const Vec3 point = eye + (along - std::sqrt(inside)) * ray;
            list.pixel.push_back(y * sphere_size + x);
            list.normal.push_back(glm::normalize(point));
            list.view.push_back(-ray);
        }
    }
    return list;
}

}  // namespace

Section sphere_section(const Folders& folders, const std::string& light_name) {
    const auto folder = folders.data / "spheres" / light_name;
    const Image map = load_image(folders.data / "env" / (light_name + ".hdr"));
    const EnvironmentLight light = prefilter(map);
    const ExactSplitSum coarse(map, 1), fine(map, 3);
    const Model sphere = make_unit_sphere(256, 512);
    const Geometry geometry = Geometry::from_model(sphere);
    Camera camera;
    camera.camera_to_world[3] = Vec4(0, 0, 4, 1);
    camera.field_of_view_x = 32 * pi / 180;
    const at::Tensor mask = load_reference(folder / "mask.png").select(2, 0);
    const PixelList pixels = inner_pixels(mask, camera, stride);
    const at::Tensor index = at::tensor(pixels.pixel);
    const at::Tensor inner = at::tensor(inner_pixels(mask, camera, 1).pixel);
    const auto at = [&](const at::Tensor& image, const at::Tensor& places) {
        return image.reshape({sphere_size * sphere_size, -1})
            .index_select(0, places)
            .narrow(1, 0, 3);
    };

    Section section;
    section.title = "Spheres under " + light_name;
    section.text = fmt::format(
        "A difference is the mean absolute difference over the mean of the reference. In brackets "
        "stands the median of the relative differences of single values. The reference is the "
        "path-traced reflectance of Lambert and GGX.\n\n"
        "| column | compares | with | at |\n|---|---|---|---|\n"
        "| *split sum* | the approximation itself, summed over every texel | the reference "
        "| {0} pixels |\n"
        "| *ours there* | our render | the reference | the same {0} pixels |\n"
        "| *ours to the split sum* | our render: the effect of the chain of levels and of the lean "
        "of rough lobes | the split sum | the same {0} pixels |\n"
        "| *ours, all pixels* | our render | the reference | all {1} pixels inside the sphere |\n"
        "| *models* | Disney's reflectance | the reference | all pixels |\n"
        "| *energy* | our sum | the reference's sum (a ratio) | all pixels |\n"
        "| *with multiple scattering* | our sum with multiple scattering, which the reference does "
        "not have | the reference's sum (a ratio) | all pixels |\n\n",
        pixels.pixel.size(), inner.size(0));
    section.columns = {"metallic",
                       "roughness",
                       "split sum",
                       "ours there",
                       "ours to the split sum",
                       "ours, all pixels",
                       "models",
                       "energy",
                       "with multiple scattering"};
    std::vector<std::vector<at::Tensor>> tiles(3);
    for (const int metallic : {0, 1}) {
        for (const auto& [name, roughness] :
             std::vector<std::pair<std::string, float>>{{"r0p1", 0.1f},
                                                        {"r0p25", 0.25f},
                                                        {"r0p5", 0.5f},
                                                        {"r0p75", 0.75f},
                                                        {"r1", 1.0f}}) {
            const std::string file = fmt::format("_m{}_{}.exr", metallic, name);
            const at::Tensor traced = load_reference(folder / ("lambertggx" + file));
            const at::Tensor disney = load_reference(folder / ("principled" + file));
            const at::Tensor split =
                (roughness < 0.4f ? fine : coarse)
                    .radiance(pixels.normal, pixels.view,
                              std::vector<Vec3>(pixels.normal.size(), base_color),
                              static_cast<float>(metallic), roughness);
            Model model = sphere;
            model.materials[0].base_color_factor = Vec4(base_color, 1);
            model.materials[0].metallic_factor = static_cast<float>(metallic);
            model.materials[0].roughness_factor = roughness;
            const auto ours = [&](bool multiple_scattering) {
                RenderOptions options;
                options.width = options.height = sphere_size;
                options.supersampling = 1;
                options.shade.multiple_scattering = multiple_scattering;
                return render(geometry, TexturedMaterials(model), light, {camera}, options)[0];
            };
            const at::Tensor single = ours(false), multiple = ours(true);
            const Difference approximation = difference(split, at(traced, index));
            const Difference chain = difference(at(single, index), split);
            const Difference sampled = difference(at(single, index), at(traced, index));
            const Difference all = difference(at(single, inner), at(traced, inner));
            const Difference models = difference(at(disney, inner), at(traced, inner));
            const Difference boosted = difference(at(multiple, inner), at(traced, inner));
            const auto cell = [](const Difference& d) {
                return fmt::format("{:.1f} % ({:.1f})", 100 * d.mean, 100 * d.median);
            };
            section.rows.push_back({std::to_string(metallic), fmt::format("{:.2f}", roughness),
                                    cell(approximation), cell(sampled), cell(chain), cell(all),
                                    cell(models), fmt::format("{:.3f}", all.bias),
                                    fmt::format("{:.3f}", boosted.bias)});
            section.numbers[fmt::format("m{}_{}", metallic, name)] = {
                {"split_sum", approximation.mean},
                {"models", models.mean},
                {"ours_to_split_sum", chain.mean},
                {"ours_there", sampled.mean},
                {"ours", all.mean},
                {"ours_median", all.median},
                {"split_sum_median", approximation.median},
                {"energy", all.bias},
                {"energy_multiple_scattering", boosted.bias}};
            if (metallic == 0 && roughness != 0.5f) continue;
            const at::Tensor a = traced.narrow(2, 0, 3), b = single.narrow(2, 0, 3);
            tiles[0].push_back(a);
            tiles[1].push_back(b);
            tiles[2].push_back((a - b).abs() * 4);
        }
    }
    const std::string image = "spheres_" + light_name + ".png";
    save_tiles(folders.output / image, tiles);
    section.images = {image};
    section.text +=
        "The image below the table shows the path-traced render, ours, and four times the "
        "difference, for one dielectric (roughness 0.5) and five metals (roughness 0.1 to 1).";
    return section;
}

}  // namespace item3d::reference
