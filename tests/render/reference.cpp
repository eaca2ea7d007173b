// Comparisons with images and tables that other software made (Mitsuba 3, NumPy).

#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/render.h"
#include "item3d/render/scatter.h"
#include "item3d/render/texture.h"
#include "item3d/render/textured_materials.h"
#include "tests/support/difference.h"
#include "tests/support/reference_images.h"
#include "tests/support/render.h"

namespace item3d {
namespace {

using reference_data::reference_sets;
using reference_data::ReferenceSet;
using testing::difference;

Image load_reference_light(const std::string& name) {
    return load_image(reference_data::crops() / "env" / (name + ".hdr"));
}

TEST(Reference, BsdfTable) {
    const std::string file = "dfg/dfg_correlated.bin";
    for (const ReferenceSet& set : reference_sets()) {
        const at::Tensor ours = set.crop(file, bsdf_table());
        const at::Tensor theirs = set.numbers(file).reshape_as(ours);
        const at::Tensor error = (ours - theirs).abs();
        const double mean = error.mean().item<double>();
        const double near = (error < 1e-3f).to(at::kFloat).mean().item<double>();
        std::printf("[ table, %s: mean error %.5f, below 0.001 %.3f ]\n", set.name(), mean, near);
        // The reference samples half vectors at 128 x 128 midpoints. Its error is up to 0.03 at
        // grazing angles on smooth surfaces; elsewhere both agree.
        EXPECT_LT(mean, 1.5e-3) << set.name() << ": " << difference(ours, theirs);
        EXPECT_GT(near, 0.75) << set.name() << ": " << difference(ours, theirs);
    }
}

TEST(Reference, Irradiance) {
    constexpr std::int64_t height = 128, width = 256;
    for (const std::string name : {"sky_noon", "studio"}) {
        const EnvironmentLight light = prefilter(load_reference_light(name), 64);
        // A white diffuse surface shows the irradiance; it is seen at every normal of the
        // reference.
        Surface surface;
        surface.pixel = at::arange(height * width);
        surface.normal = at::empty({height * width, 3});
        auto normals = surface.normal.accessor<float, 2>();
        for (std::int64_t i = 0; i < height * width; ++i) {
            const Vec3 d = equirectangular_direction(
                (static_cast<float>(i % width) + 0.5f) / static_cast<float>(width),
                (static_cast<float>(i / width) + 0.5f) / static_cast<float>(height));
            for (int c = 0; c < 3; ++c)
                normals[i][c] = d[c];
        }
        surface.view = surface.normal;
        surface.tangent = at::zeros({height * width, 4});
        MaterialSample white;
        white.base_color = at::ones({height * width, 3});
        white.orm = at::tensor({1.0f, 1.0f, 0.0f}).expand({height * width, 3});
        EnvironmentLight diffuse_only = light;
        for (at::Tensor& level : diffuse_only.specular)
            level = at::zeros_like(level);
        const at::Tensor irradiance =
            shade(surface, white, diffuse_only).reshape({height, width, 3});
        for (const ReferenceSet& set : reference_sets()) {
            const std::string file = "env/" + name + "_irradiance.exr";
            const at::Tensor ours = set.crop(file, irradiance), theirs = set.image(file);
            const at::Tensor error = (ours - theirs).abs();
            const double mean = error.mean().item<double>(), largest = error.max().item<double>();
            std::printf("[ irradiance %s, %s: mean error %.5f, largest %.5f of 1 ]\n", name.c_str(),
                        set.name(), mean, largest);
            EXPECT_LT(mean, 0.0005) << file << ": " << difference(ours, theirs);
            EXPECT_LT(largest, 0.003) << file << ": " << difference(ours, theirs);
        }
    }
}

TEST(Reference, GradientOfABaseColourTexture) {
    const ReferenceSet set(reference_data::crops());
    const Model model = load_model(set.folder() / "meshes" / "spot" / "spot.obj");
    const Geometry geometry = Geometry::from_model(model);
    Camera camera;
    const float rows[4][4] = {{-0.70710678f, -0.5f, 0.5f, 1.66471517f},
                              {0, 0.70710678f, 0.70710678f, 2.46269378f},
                              {-0.70710678f, 0.5f, -0.5f, -1.47466967f},
                              {0, 0, 0, 1}};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            camera.camera_to_world[column][row] = rows[row][column];
    camera.field_of_view_x = 39.6f * pi / 180;
    constexpr int size = 128, grid = 8;
    const Raster raster = rasterize(geometry, {camera}, size * grid, size * grid);
    const Surface surface = interpolate_surface(geometry, raster, {camera});
    EnvironmentLight light = prefilter(load_reference_light("sky_noon"), 64);
    for (at::Tensor& level : light.specular)
        level = at::zeros_like(level);

    at::Tensor texture =
        set.image("gradcheck/texture_now.exr").contiguous().set_requires_grad(true);
    MaterialSample material;
    material.base_color = sample_texture(texture, surface.uv);
    material.orm = at::tensor({1.0f, 1.0f, 0.0f}).expand({surface.count(), 3});
    const at::Tensor fine =
        scatter(shade(surface, material, light), surface, raster, at::zeros({3}))[0];
    const at::Tensor picture = fine.reshape({size, grid, size, grid, 3}).mean({1, 3});
    const at::Tensor target = set.image("gradcheck/ibl_target.exr");
    const at::Tensor loss = (picture - target).square().mean();
    loss.backward();
    const at::Tensor expected = set.image("gradcheck/ibl_gradient.exr"), found = texture.grad();
    const double cosine =
        ((found * expected).sum() / found.norm() / expected.norm()).item<double>();
    const double relative = ((found - expected).norm() / expected.norm()).item<double>();
    // The crop has the whole model, and its background is black: the mean errors' ratio is that of
    // whole images.
    const at::Tensor image = set.image("gradcheck/ibl_image.exr");
    const at::Tensor ours = set.crop("gradcheck/ibl_image.exr", picture.detach());
    const double image_error = ((ours - image).abs().mean() / image.mean()).item<double>();
    std::printf("[ texture gradient: cosine %.5f, relative error %.4f; picture %.4f ]\n", cosine,
                relative, image_error);
    EXPECT_GT(cosine, 0.999) << difference(found, expected);
    EXPECT_LT(relative, 0.005) << difference(found, expected);
    EXPECT_LT(image_error, 0.005) << difference(ours, image);
}

/// Returns the median of the relative errors of a sphere's pixels, and the ratio of sums: split-sum
/// is an approximation, and a small sun's mirror image moves much energy over few pixels.
std::array<double, 2> sphere_error(const ReferenceSet& set, const std::string& folder,
                                   const std::string& file, const at::Tensor& image) {
    const at::Tensor reference = set.image(folder + file);
    const at::Tensor inside = (set.image(folder + "mask.png") > 0.999f).expand_as(reference);
    const at::Tensor theirs = reference.masked_select(inside);
    const at::Tensor ours = set.crop(folder + file, image).masked_select(inside);
    return {((ours - theirs).abs() / theirs).median().item<double>(),
            (ours.sum() / theirs.sum()).item<double>()};
}

TEST(Reference, Spheres) {
    const Model sphere = make_unit_sphere(180, 360);
    const Geometry geometry = Geometry::from_model(sphere);
    const Camera camera = testing::front_camera(4, 32 * pi / 180);
    const std::vector<ReferenceSet> sets = reference_sets();
    for (const std::string light_name : {"studio", "sky_noon"}) {
        const EnvironmentLight light = prefilter(load_reference_light(light_name), 64);
        const std::string folder = "spheres/" + light_name + "/";
        for (const int metallic : {0, 1}) {
            for (const auto& [name, roughness] : std::vector<std::pair<std::string, float>>{
                     {"r0p1", 0.1f}, {"r0p5", 0.5f}, {"r1", 1.0f}}) {
                Model model = sphere;
                model.materials[0].base_color_factor = Vec4(0.8f, 0.45f, 0.2f, 1);
                model.materials[0].metallic_factor = static_cast<float>(metallic);
                model.materials[0].roughness_factor = roughness;
                const auto image = [&](bool multiple_scattering) {
                    RenderOptions options;
                    options.width = options.height = 256;
                    options.supersampling = 1;
                    options.shade.multiple_scattering = multiple_scattering;
                    return render(geometry, TexturedMaterials(model), light, {camera}, options)[0]
                        .narrow(2, 0, 3);
                };
                const at::Tensor single = image(false), multiple = image(true);
                const std::string file =
                    "lambertggx_m" + std::to_string(metallic) + "_" + name + ".exr";
                for (const ReferenceSet& set : sets) {
                    const auto of_single = sphere_error(set, folder, file, single);
                    const auto of_multiple = sphere_error(set, folder, file, multiple);
                    std::printf(
                        "[ sphere %-8s metallic %d roughness %.2f, %s: median error %.3f, sum "
                        "%.3f; with multiple scattering %.3f, %.3f ]\n",
                        light_name.c_str(), metallic, roughness, set.name(), of_single[0],
                        of_single[1], of_multiple[0], of_multiple[1]);
                    EXPECT_LT(of_single[0], 0.14)
                        << set.name() << " of " << folder + file << ": "
                        << difference(set.crop(folder + file, single), set.image(folder + file));
                }
            }
        }
    }
}

}  // namespace
}  // namespace item3d
