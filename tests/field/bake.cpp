// Tests of fitting and baking: a field starts with the source's look, and textures keep the texels
// that were not edited.
#include "item3d/field/bake/bake.h"

#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/field/fit.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

using testing::make_model;
using testing::make_quad;
using testing::make_sphere;

/// Makes a small field: the tests' textures are 64 texels wide.
NeuralTexture make_field(const FieldSpace& space) {
    NeuralTextureOptions options;
    options.levels = 5;
    options.log2_table_size = 14;
    options.base_resolution = 8;
    options.finest_resolution = 96;
    options.bounds = space.bounds();
    return NeuralTexture(options);
}

FitOptions quick_fit(int steps = 150) {
    FitOptions options;
    options.steps = steps;
    options.batch = 2048;
    options.show_progress = false;
    return options;
}

BakeOptions quiet_bake() {
    BakeOptions options;
    options.show_progress = false;
    return options;
}

double texel_psnr(const Image& a, const Image& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double d = static_cast<double>(a.pixels[i]) - b.pixels[i];
        sum += d * d;
    }
    return -10.0 * std::log10(std::max(1e-12, sum / static_cast<double>(a.pixels.size())));
}

/// A model and the inputs of baking, with a field that is fitted to the model.
struct Fitted {
    explicit Fitted(Model m, int steps = 150)
        : model((set_verbosity(Verbosity::quiet), std::move(m))),
          geometry(Geometry::from_model(model)),
          materials(model),
          space(model, {0}),
          atlas(make_atlas(model, space, {0}, 64)),
          field(make_field(space)) {
        result = fit_to_materials(field, geometry, space, materials, quick_fit(steps));
        before = snapshot(field);
    }
    BakeScene scene() const { return {model, geometry, materials, space, atlas}; }
    MaterialEdit bake_now(const BakeOptions& options) {
        return bake(scene(), before, field, options).materials.at(0);
    }
    /// Trains the field's colour to blue, as an edit does.
    void paint_blue() {
        Adam adam;
        adam.add_group("table", {field->table()}, {.learning_rate = 0.02});
        adam.add_group("network", field->network_parameters(), {.learning_rate = 0.005});
        const SurfaceSampler sampler(geometry, space);
        Random random(5);
        const at::Tensor goal = at::tensor({0.05f, 0.1f, 0.8f});
        for (int i = 0; i < 100; ++i) {
            const MaterialSample sample =
                field->forward(space.positions(sampler.sample(1024, random)));
            adam.zero_grad();
            ((sample.base_color - goal).square().mean() +
             (sample.orm.select(1, 2) - 1.0f).square().mean())
                .backward();
            adam.step();
        }
        adam.zero_grad();
    }

    Model model;
    Geometry geometry;
    TexturedMaterials materials;
    FieldSpace space;
    Atlas atlas;
    NeuralTexture field;
    NeuralTexture before{nullptr};
    FitResult result;
};

TEST(NeuralTexture, GradientsOfTheNetworkMatchFiniteDifferences) {
    NeuralTextureOptions options;
    options.levels = 3;
    options.log2_table_size = 10;
    options.finest_resolution = 40;
    NeuralTexture field(options);
    {
        const at::NoGradGuard no_grad;
        at::manual_seed(3);
        field->table().normal_(0.0, 0.5);
    }
    const at::Tensor positions = at::rand({40, 3}) * 1.8f - 0.9f;
    const at::Tensor weight = at::randn({40, 9});
    const auto value = [&] {
        const MaterialSample s = field->forward(positions);
        return (at::cat({s.base_color, s.orm, s.normal}, 1) * weight).sum();
    };
    value().backward();
    const at::NoGradGuard no_grad;
    Random random(1);
    int checked = 0;
    for (const auto& [name, parameter] : field->named_parameters()) {
        const at::Tensor gradient = parameter.grad().to_dense().view(-1);
        for (int k = 0; k < 60; ++k) {
            const std::int64_t at = random.index(parameter.numel());
            const float wanted = gradient[at].item<float>();
            if (std::abs(wanted) < 0.01f) continue;
            const float step = 3e-4f;  // a larger one crosses kinks of relu
            const at::Tensor flat = parameter.view(-1);
            flat[at] += step;
            const float above = value().item<float>();
            flat[at] -= 2.0f * step;
            const float below = value().item<float>();
            flat[at] += step;
            EXPECT_NEAR((above - below) / (2.0f * step), wanted, 0.02f + 0.03f * std::abs(wanted))
                << name;
            ++checked;
        }
    }
    EXPECT_GT(checked, 60);
}

TEST(NeuralTexture, StaysInItsRanges) {
    NeuralTextureOptions options;
    options.ranges.base_color = {0.2f, 0.6f};
    options.ranges.roughness = {0.08f, 0.7f};
    options.ranges.metallic = {0.0f, 0.0f};
    NeuralTexture field(options);
    const at::NoGradGuard no_grad;
    at::manual_seed(4);
    field->table().normal_(0.0, 50.0);
    const MaterialSample sample = field->forward(at::rand({500, 3}) * 2.0f - 1.0f);
    EXPECT_NEAR(linear_to_srgb(sample.base_color).min().item<float>(), 0.2f, 1e-3f);
    EXPECT_NEAR(linear_to_srgb(sample.base_color).max().item<float>(), 0.6f, 1e-3f);
    EXPECT_NEAR(sample.orm.select(1, 1).max().item<float>(), 0.7f, 1e-5f);
    EXPECT_EQ(sample.orm.select(1, 2).abs().max().item<float>(), 0.0f);
    EXPECT_NEAR((sample.normal.square().sum(1) - 1.0f).abs().max().item<float>(), 0.0f, 1e-5f);
}

TEST(NeuralTexture, AGainOfTheBaseColorEndsAtOneAndItsGradientDoesNot) {
    NeuralTexture field(NeuralTextureOptions{});
    const at::Tensor positions = at::rand({50, 3}) * 1.8f - 0.9f;
    const at::Tensor plain = field->forward(positions).base_color.detach();
    field->set_base_color_gain(at::tensor({0.5f, 1.0f, 9.0f}));
    const at::Tensor color = field->forward(positions).base_color;
    EXPECT_TRUE(at::allclose(color.select(1, 0), 0.5f * plain.select(1, 0)));
    EXPECT_TRUE(at::allclose(color.select(1, 1), plain.select(1, 1)));
    EXPECT_FLOAT_EQ(color.select(1, 2).min().item<float>(), 1.0f);
    color.select(1, 2).sum().backward();
    EXPECT_GT(field->network_parameters().back().grad()[2].item<float>(), 0);
}

TEST(Fit, ReachesTheTexturesOnASphere) {
    const Fitted sphere(make_model(make_sphere()), 200);
    EXPECT_GT(sphere.result.base_color_psnr, 33.0);
    EXPECT_GT(sphere.result.orm_psnr, 27.0);  // metallic jumps from 0 to 1 along a meridian
}

TEST(Fit, ShiftsMetallicToAMean) {
    Fitted sphere(make_model(make_sphere()), 50);
    const at::NoGradGuard no_grad;
    const auto sample = [&] {
        Random random(3);
        const Surface surface = SurfaceSampler(sphere.geometry, sphere.space).sample(2000, random);
        return sphere.field->forward(sphere.space.positions(surface));
    };
    const MaterialSample before = sample();
    for (const float mean : {0.5f, 0.2f, 0.8f}) {
        shift_mean(sphere.field, sphere.geometry, sphere.space, OrmChannel::metallic, mean);
        EXPECT_NEAR(sample().orm.select(1, 2).mean().item<float>(), mean, 0.02f);
    }
    EXPECT_TRUE(at::equal(sample().base_color, before.base_color));
    EXPECT_TRUE(at::equal(sample().orm.select(1, 1), before.orm.select(1, 1)));
}

TEST(Fit, LeavesTheTableOfAPlainSurfaceAlmostEmpty) {
    Model model = make_model(make_sphere());
    for (Texture& texture : model.textures)
        std::fill(texture.image.pixels.begin(), texture.image.pixels.end(), 0.3f);
    const Fitted plain(model), patterned(make_model(make_sphere()));
    EXPECT_GT(plain.result.base_color_psnr, 45.0);
    const auto spread = [](const Fitted& fitted) {
        return fitted.field->table().detach().std().item<float>();
    };
    EXPECT_LT(spread(plain), 0.2f * spread(patterned));
}

TEST(Fit, IsDeterministic) {
    const Fitted one(make_model(make_quad()), 20);
    const Fitted two(make_model(make_quad()), 20);
    EXPECT_TRUE(at::equal(one.field->table(), two.field->table()));
}

TEST(Bake, ReturnsTheSourceWhenNothingChanged) {
    Fitted sphere(make_model(make_sphere()), 60);
    const MaterialEdit edit = sphere.bake_now(quiet_bake());
    ASSERT_TRUE(edit.base_color && edit.metallic_roughness);
    EXPECT_FALSE(edit.normal);
    EXPECT_EQ(edit.base_color->pixels, sphere.model.textures[0].image.pixels);
    EXPECT_EQ(edit.metallic_roughness->pixels, sphere.model.textures[1].image.pixels);
}

TEST(Bake, ReturnsTheSourceResampledAtAnotherSize) {
    Model model = make_model(make_quad(), 64);
    // Bilinear magnification of a smooth image must be close to the image drawn at the larger size.
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x)
            model.textures[0].image.at(x, y, 2) = 0.5f;
    }
    Image large = testing::make_colors(128);
    for (std::size_t i = 2; i < large.pixels.size(); i += 3)
        large.pixels[i] = 0.5f;
    Fitted quad(model, 40);
    BakeOptions options = quiet_bake();
    options.texture_size = 128;
    const MaterialEdit edit = quad.bake_now(options);
    ASSERT_EQ(edit.base_color->width, 128);
    EXPECT_GT(texel_psnr(*edit.base_color, large), 38.0);
}

TEST(Bake, ReturnsTheFactorsOfAMaterialWithoutTextures) {
    Model model = make_model(make_quad());
    model.materials[0] = Material{};
    model.materials[0].base_color_factor = Vec4(0.5f, 0.2f, 0.1f, 1.0f);
    model.materials[0].roughness_factor = 0.6f;
    model.materials[0].metallic_factor = 0.0f;
    Fitted quad(model, 40);
    BakeOptions options = quiet_bake();
    options.texture_size = 32;
    const MaterialEdit edit = quad.bake_now(options);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(edit.base_color->at(16, 9, c),
                    linear_to_srgb(model.materials[0].base_color_factor[c]), 1e-4f);
    }
    EXPECT_NEAR(edit.metallic_roughness->at(3, 30, 0), 1.0f, 1e-5f);
    EXPECT_NEAR(edit.metallic_roughness->at(3, 30, 1), 0.6f, 1e-5f);
    EXPECT_NEAR(edit.metallic_roughness->at(3, 30, 2), 0.0f, 1e-5f);
}

TEST(Bake, KeptChannelsAreBitIdentical) {
    Fitted sphere(make_model(make_sphere()));
    sphere.paint_blue();
    BakeOptions options = quiet_bake();
    options.channels.roughness = false;
    const MaterialEdit edit = sphere.bake_now(options);
    const Image& source = sphere.model.textures[1].image;
    double metallic_change = 0.0;
    for (std::size_t i = 0; i < source.pixels.size(); i += 3) {
        ASSERT_EQ(edit.metallic_roughness->pixels[i], source.pixels[i]);
        ASSERT_EQ(edit.metallic_roughness->pixels[i + 1], source.pixels[i + 1]);
        metallic_change += std::abs(edit.metallic_roughness->pixels[i + 2] - source.pixels[i + 2]);
    }
    EXPECT_GT(metallic_change / (64 * 64), 0.3);
    EXPECT_TRUE(edit.keeps_orm_texels);
    options.channels.occlusion = options.channels.roughness = true;
    EXPECT_FALSE(sphere.bake_now(options).keeps_orm_texels);
    options.channels = {
        .base_color = false, .occlusion = false, .roughness = false, .metallic = false};
    const MaterialEdit nothing = sphere.bake_now(options);
    EXPECT_FALSE(nothing.base_color || nothing.metallic_roughness || nothing.normal);
}

TEST(Bake, TakesTheNewColourAndKeepsTheFineLuminance) {
    // The texture is a flat colour with a checkerboard of single texels, which the field cannot
    // represent.
    Model model = make_model(make_quad());
    Image& image = model.textures[0].image;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const float value = (x + y) % 2 == 0 ? 0.55f : 0.45f;
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = c == 0 ? value + 0.3f : value;
        }
    }
    Fitted quad(model);
    quad.paint_blue();
    const MaterialEdit edit = quad.bake_now(quiet_bake());
    double mean[3] = {}, contrast = 0.0;
    for (int y = 8; y < 56; ++y) {
        for (int x = 8; x < 56; ++x) {
            for (int c = 0; c < 3; ++c)
                mean[c] += edit.base_color->at(x, y, c) / (48.0 * 48.0);
            contrast +=
                ((x + y) % 2 == 0 ? 2.0 : -2.0) * edit.base_color->at(x, y, 1) / (48.0 * 48.0);
        }
    }
    EXPECT_NEAR(mean[0], linear_to_srgb(0.05f), 0.06);
    EXPECT_NEAR(mean[1], linear_to_srgb(0.1f), 0.06);
    EXPECT_NEAR(mean[2], linear_to_srgb(0.8f), 0.06);
    EXPECT_GT(contrast, 0.05);  // 0.1 in the source
}

/// Returns the range of the green values in a part of a row.
float green_range(const Image& image, int y, int first, int last) {
    float low = 1, high = 0;
    for (int x = first; x < last; ++x) {
        low = std::min(low, image.at(x, y, 1));
        high = std::max(high, image.at(x, y, 1));
    }
    return high - low;
}

TEST(Bake, LeavesNoOutlineOfAMarkingThatWasPaintedOver) {
    // The texture shows half of a dark disc, whose edge the field can only blur, and dots far from
    // it.
    Model model = make_model(make_quad());
    Image& image = model.textures[0].image;
    const auto is_dot = [](int x, int y) { return x >= 52 && x % 4 == 0 && y % 4 == 0; };
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = x < 24 ? 0.2f : is_dot(x, y) ? 0.6f : 0.8f;
        }
    }
    Fitted quad(model, 30);
    quad.paint_blue();
    const MaterialEdit edit = quad.bake_now(quiet_bake());
    EXPECT_LT(green_range(*edit.base_color, 33, 16, 32), 0.1);  // 0.25 if nothing had changed
    EXPECT_GT(green_range(*edit.base_color, 32, 54, 62), 0.1);  // 0.2 in the source
}

TEST(Bake, KeepsAlpha) {
    Model model = make_model(make_quad());
    Image rgba(64, 64, 4);
    for (int i = 0; i < 64 * 64; ++i) {
        for (int c = 0; c < 3; ++c)
            rgba.pixels[static_cast<std::size_t>(4 * i + c)] = 0.4f;
        rgba.pixels[static_cast<std::size_t>(4 * i + 3)] = static_cast<float>(i % 7) / 255.0f;
    }
    model.textures[0].image = rgba;
    model.materials[0].alpha = Material::Alpha::blend;
    Fitted quad(model);
    quad.paint_blue();
    const MaterialEdit edit = quad.bake_now(quiet_bake());
    ASSERT_EQ(edit.base_color->channels, 4);
    for (std::size_t i = 3; i < rgba.pixels.size(); i += 4) {
        ASSERT_EQ(edit.base_color->pixels[i], rgba.pixels[i]);
    }
}

TEST(Bake, VertexColoursBecomePartOfTheTexture) {
    Model model = make_model(make_quad());
    EXPECT_FALSE(Fitted(model, 5).bake_now(quiet_bake()).includes_vertex_colors);
    model.primitives[0].colors.assign(4, Vec4(0.5f, 0.25f, 1.0f, 1.0f));
    Fitted quad(model, 60);
    const MaterialEdit edit = quad.bake_now(quiet_bake());
    EXPECT_TRUE(edit.includes_vertex_colors);
    Image wanted = model.textures[0].image;
    for (std::size_t i = 0; i < wanted.pixels.size(); ++i) {
        const float factor = model.primitives[0].colors[0][static_cast<int>(i % 3)];
        wanted.pixels[i] = linear_to_srgb(srgb_to_linear(wanted.pixels[i]) * factor);
    }
    EXPECT_GT(texel_psnr(*edit.base_color, wanted), 30.0);  // resampled, not copied
}

TEST(Bake, DoesNotSwitchOnOcclusionThatTheMaterialLacks) {
    Model model = make_model(make_quad());
    model.materials[0].occlusion_texture = -1;
    Fitted quad(model, 60);
    quad.paint_blue();
    const MaterialEdit edit = quad.bake_now(quiet_bake());
    for (std::size_t i = 0; i < edit.metallic_roughness->pixels.size(); i += 3) {
        ASSERT_EQ(edit.metallic_roughness->pixels[i], 1.0f);
    }
}

TEST(Bake, ShowsNoSeamWhereChartsMeet) {
    // The sphere's texture ends at u = 0 and at u = 1, which are the same meridian. After an edit,
    // bilinear lookups on the two sides of this meridian agree as well as lookups of neighbours
    // elsewhere.
    Fitted sphere(make_model(make_sphere()));
    sphere.paint_blue();
    const MaterialEdit edit = sphere.bake_now(quiet_bake());
    const Image& image = *edit.base_color;
    double across = 0.0, inside = 0.0;
    for (int y = 8; y < 56; ++y) {
        for (int c = 0; c < 3; ++c) {
            across += std::abs(image.at(63, y, c) - image.at(0, y, c));
            for (int x = 10; x < 50; ++x) {
                inside += std::abs(image.at(x + 1, y, c) - image.at(x, y, c)) / 40.0;
            }
        }
    }
    EXPECT_LT(across, 2.0 * inside + 0.01 * 48 * 3);
}

TEST(Bake, NewUvMapShowsTheSourceWithoutSeams) {
    // The source's map cannot be used, because it winds round the texture twice. Through the new
    // map, the baked texture must look like the old texture, also along the new map's seams.
    Model model = make_model(make_sphere());
    for (Vec2& uv : model.primitives[0].uvs)
        uv.x *= 2.0f;
    Fitted sphere(model, 60);
    ASSERT_FALSE(sphere.atlas.sets.at(0).is_own());
    BakeOptions options = quiet_bake();
    options.texture_size = 256;
    sphere.atlas = make_atlas(model, sphere.space, {0}, 256);
    const ModelEdit edit = bake(sphere.scene(), sphere.before, sphere.field, options);
    Model remade = model;
    remade.primitives[0] = apply(edit.primitives.at(0), model.primitives[0]);
    remade.textures[0].image = *edit.materials.at(0).base_color;
    remade.textures[1].image = *edit.materials.at(0).metallic_roughness;
    const Geometry geometry = Geometry::from_model(remade);
    Random random(8);
    const SurfaceSampler sampler(sphere.geometry, sphere.space);
    // Equal generators draw the same triangles and weights on both models.
    Random same = random;
    const Surface before = sampler.sample(20000, random);
    const Surface after = SurfaceSampler(geometry, sphere.space).sample(20000, same);
    ASSERT_LT((before.position - after.position).abs().max().item<float>(), 1e-5f);
    const at::Tensor wanted = linear_to_srgb(sphere.materials.sample(before).base_color);
    const at::Tensor found = linear_to_srgb(TexturedMaterials(remade).sample(after).base_color);
    const at::Tensor error = (wanted - found).abs();
    EXPECT_GT(-10.0 * std::log10(error.square().mean().item<double>()), 35.0);
    EXPECT_LT(error.max().item<float>(), 0.15f);  // a seam would show the background
}

}  // namespace
}  // namespace item3d
