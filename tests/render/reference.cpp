// Comparisons with images and tables made by other software (Mitsuba 3, NumPy).

#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/render.h"
#include "item3d/render/scatter.h"
#include "item3d/render/texture.h"
#include "item3d/render/textured_materials.h"
#include "tests/support/render.h"

#include <filesystem>
#include <fstream>

namespace item3d {
namespace {

const std::filesystem::path shared = std::filesystem::path(ITEM3D_SHARED_DATA) / "data";

at::Tensor load(const std::filesystem::path& path) {
    return to_tensor(load_image(path));
}

TEST(Reference, BsdfTable) {
    const auto path = shared / "dfg" / "dfg_correlated.bin";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no reference data";
    at::Tensor reference = at::empty({256, 256, 2});
    std::ifstream(path, std::ios::binary)
        .read(reinterpret_cast<char*>(reference.data_ptr<float>()),
              reference.numel() * static_cast<std::int64_t>(sizeof(float)));
    const at::Tensor error = (bsdf_table() - reference).abs();
    // The reference samples half vectors on 128 x 128 midpoints, which is off by up to 0.03 at
    // grazing angles on smooth surfaces; elsewhere both agree.
    EXPECT_LT(error.mean().item<float>(), 1.5e-3);
    EXPECT_GT((error < 1e-3f).to(at::kFloat).mean().item<float>(), 0.75);
}

TEST(Reference, Irradiance) {
    if (!std::filesystem::exists(shared / "env")) GTEST_SKIP() << "no reference data";
    for (const char* name : {"sky_noon", "studio"}) {
        const Image map = load_image(shared / "env" / (std::string(name) + ".hdr"));
        const EnvironmentLight light = prefilter(map, 64);
        const at::Tensor reference =
            load(shared / "env" / (std::string(name) + "_irradiance.exr")).narrow(2, 0, 3);
        // A white diffuse surface shows the irradiance; it is seen at every normal of the
        // reference.
        const std::int64_t height = reference.size(0), width = reference.size(1);
        Surface surface;
        surface.pixel = at::arange(height * width);
        surface.normal = at::empty({height * width, 3});
        for (std::int64_t i = 0; i < height * width; ++i) {
            const Vec3 d = equirectangular_direction(
                (static_cast<float>(i % width) + 0.5f) / static_cast<float>(width),
                (static_cast<float>(i / width) + 0.5f) / static_cast<float>(height));
            for (int c = 0; c < 3; ++c)
                surface.normal[i][c] = d[c];
        }
        surface.view = surface.normal;
        surface.tangent = at::zeros({height * width, 4});
        MaterialSample white;
        white.base_color = at::ones({height * width, 3});
        white.orm = at::tensor({1.0f, 1.0f, 0.0f}).expand({height * width, 3});
        EnvironmentLight diffuse_only = light;
        for (at::Tensor& level : diffuse_only.specular)
            level = at::zeros_like(level);
        const at::Tensor error =
            (shade(surface, white, diffuse_only).reshape_as(reference) - reference).abs();
        std::printf("[ irradiance %s: mean error %.5f, largest %.5f of 1 ]\n", name,
                    error.mean().item<float>(), error.max().item<float>());
        EXPECT_LT(error.mean().item<float>(), 0.0005) << name;
        EXPECT_LT(error.max().item<float>(), 0.003) << name;
    }
}

TEST(Reference, GradientOfABaseColourTexture) {
    const auto folder = shared / "gradcheck";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference data";
    const Model model = load_model(shared / "meshes" / "spot" / "spot.obj");
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
    EnvironmentLight light = prefilter(load_image(shared / "env" / "sky_noon.hdr"), 64);
    for (at::Tensor& level : light.specular)
        level = at::zeros_like(level);

    at::Tensor texture =
        load(folder / "texture_now.exr").narrow(2, 0, 3).contiguous().set_requires_grad(true);
    MaterialSample material;
    material.base_color = sample_texture(texture, surface.uv);
    material.orm = at::tensor({1.0f, 1.0f, 0.0f}).expand({surface.count(), 3});
    const at::Tensor fine =
        scatter(shade(surface, material, light), surface, raster, at::zeros({3}))[0];
    const at::Tensor picture = fine.reshape({size, grid, size, grid, 3}).mean({1, 3});
    const at::Tensor target = load(folder / "ibl_target.exr").narrow(2, 0, 3);
    const at::Tensor loss = (picture - target).square().mean();
    loss.backward();
    const at::Tensor expected = load(folder / "ibl_gradient.exr").narrow(2, 0, 3);
    const at::Tensor found = texture.grad();
    const double cosine =
        ((found * expected).sum() / found.norm() / expected.norm()).item<double>();
    const double relative = ((found - expected).norm() / expected.norm()).item<double>();
    const at::Tensor image = load(folder / "ibl_image.exr").narrow(2, 0, 3);
    const double image_error = ((picture - image).abs().mean() / image.mean()).item<double>();
    std::printf("[ texture gradient: cosine %.5f, relative error %.4f; picture %.4f ]\n", cosine,
                relative, image_error);
    EXPECT_GT(cosine, 0.999);
    EXPECT_LT(relative, 0.005);
    EXPECT_LT(image_error, 0.005);
}

TEST(Reference, Spheres) {
    const auto folder = shared / "spheres";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference data";
    const Model sphere = make_unit_sphere(180, 360);
    const Geometry geometry = Geometry::from_model(sphere);
    Camera camera = testing::front_camera(4, 32 * pi / 180);
    // Median of the relative errors of pixels, and the ratio of sums: split-sum is an
    // approximation, and a small sun's mirror image moves much energy over few pixels.
    for (const char* light_name : {"studio", "sky_noon"}) {
        const EnvironmentLight light =
            prefilter(load_image(shared / "env" / (std::string(light_name) + ".hdr")), 64);
        const at::Tensor mask = load(folder / light_name / "mask.png").select(2, 0) > 0.999f;
        for (const char* metallic : {"0", "1"}) {
            for (const auto& [name, roughness] : std::vector<std::pair<std::string, float>>{
                     {"r0p1", 0.1f}, {"r0p5", 0.5f}, {"r1", 1.0f}}) {
                const auto path = folder / light_name /
                                  ("lambertggx_m" + std::string(metallic) + "_" + name + ".exr");
                const at::Tensor reference = load(path).narrow(2, 0, 3);
                Model model = sphere;
                model.materials[0].base_color_factor = Vec4(0.8f, 0.45f, 0.2f, 1);
                model.materials[0].metallic_factor = metallic[0] == '1' ? 1.0f : 0.0f;
                model.materials[0].roughness_factor = roughness;
                const auto error = [&](bool multiple_scattering) {
                    RenderOptions options;
                    options.width = options.height = 256;
                    options.supersampling = 1;
                    options.shade.multiple_scattering = multiple_scattering;
                    const at::Tensor picture =
                        render(geometry, TexturedMaterials(model), light, {camera}, options)[0]
                            .narrow(2, 0, 3);
                    const at::Tensor inside = mask.unsqueeze(2).expand({256, 256, 3});
                    const at::Tensor ours = picture.masked_select(inside);
                    const at::Tensor theirs = reference.masked_select(inside);
                    return std::array<double, 2>{
                        ((ours - theirs).abs() / theirs).median().item<double>(),
                        (ours.sum() / theirs.sum()).item<double>()};
                };
                const auto single = error(false), multiple = error(true);
                std::printf(
                    "[ sphere %-8s metallic %s roughness %.2f: median error %.3f, sum %.3f; with "
                    "multiple "
                    "scattering %.3f, %.3f ]\n",
                    light_name, metallic, roughness, single[0], single[1], multiple[0],
                    multiple[1]);
                EXPECT_LT(single[0], 0.14);
            }
        }
    }
}

}  // namespace
}  // namespace item3d
