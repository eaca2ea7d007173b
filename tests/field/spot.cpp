// Tests of a model from another project, from its file to images of the field and of the baked
// textures.
#include "item3d/core/progress.h"
#include "item3d/field/bake/bake.h"
#include "item3d/field/fit.h"
#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "tests/support/reference_folders.h"

#include <gtest/gtest.h>

#include <chrono>

namespace item3d {
namespace {

/// Returns sRGB images [N, H, W, 3] on a grey background, with one sample per pixel.
at::Tensor image_of(const Geometry& geometry, const std::vector<Camera>& cameras, int size,
                    const EnvironmentLight& light,
                    const std::function<MaterialSample(const Surface&)>& materials) {
    const at::NoGradGuard no_grad;
    const Raster raster = rasterize(geometry, cameras, size, size);
    const Surface surface = interpolate_surface(geometry, raster, cameras);
    const at::Tensor radiance = shade(surface, materials(surface), light);
    const at::Tensor image = scatter(radiance, surface, raster, at::full({3}, 0.2f));
    const at::Tensor encoded = linear_to_srgb(image.clamp(0.0f, 1.0f));
    return at::round(encoded * 255.0f) / 255.0f;
}

double psnr(const at::Tensor& a, const at::Tensor& b) {
    return -10.0 * std::log10(std::max(1e-12, (a - b).square().mean().item<double>()));
}

TEST(Spot, TheFieldLooksLikeTheModelAndBakesBackToItsTexture) {
    set_verbosity(Verbosity::quiet);
    const Model model = load_model(reference_data::crops() / "meshes" / "spot" / "spot.obj");
    const std::vector<int> edited{model.primitives.at(0).material};
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const FieldSpace space(model, edited);
    const Atlas atlas = make_atlas(model, space, edited);
    EXPECT_TRUE(atlas.sets.at(0).is_own()) << atlas.sets.at(0).remade;
    NeuralTexture field(
        suggest_field_options(geometry, space, atlas_size(model, edited[0], 0).first));
    FitOptions fit;
    fit.show_progress = false;
    const FitResult result = fit_to_materials(field, geometry, space, materials, fit);

    const EnvironmentLight light = prefilter(make_light_preset("studio", 64), 64);
    const std::vector<Camera> cameras = turntable(model.bounds(), 4, 0.3f, 0.7f);
    const auto textured = [&](const Surface& surface) { return materials.sample(surface); };
    const auto neural = [&](const Surface& surface) {
        MaterialSample sample = field->forward(space.positions(surface));
        return sample;
    };
    const double at_256 = psnr(image_of(geometry, cameras, 256, light, textured),
                               image_of(geometry, cameras, 256, light, neural));
    const double at_512 = psnr(image_of(geometry, cameras, 512, light, textured),
                               image_of(geometry, cameras, 512, light, neural));
    EXPECT_GT(at_256, 35.0);
    EXPECT_GT(at_512, 35.0);

    const NeuralTexture before = snapshot(field);
    NeuralTexture fitted = before;
    BakeOptions bake_options;
    bake_options.show_progress = false;
    const auto start = std::chrono::steady_clock::now();
    const ModelEdit edit =
        bake({model, geometry, materials, space, atlas}, fitted, field, bake_options);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const int texture = model.materials[static_cast<std::size_t>(edited[0])].base_color_texture;
    ASSERT_GE(texture, 0);
    const Image& source = model.textures[static_cast<std::size_t>(texture)].image;
    const Image& baked = *edit.materials.at(edited[0]).base_color;
    ASSERT_EQ(baked.width, source.width);
    EXPECT_EQ(baked.pixels, source.pixels);
    std::printf(
        "spot: finest %d, fit %.1f s, base colour %.1f dB, render %.1f dB at 256, %.1f dB at 512, "
        "bake %.1f s\n",
        field->options().finest_resolution, result.seconds, result.base_color_psnr, at_256, at_512,
        seconds);
}

}  // namespace
}  // namespace item3d
