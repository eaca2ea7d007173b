
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"
#include "item3d/render/texture.h"
#include "item3d/render/textured_materials.h"
#include "tests/support/render.h"

namespace item3d {
namespace {

using testing::front_camera;

/// Returns a quad before the camera that shows its texture once; v decreases as y grows.
Model quad_model() {
    Primitive quad;
    quad.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    quad.normals.assign(4, Vec3(0, 0, 1));
    quad.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    Model model;
    model.primitives.push_back(quad);
    model.materials.emplace_back();
    return model;
}

int add_texture(Model& model, const Image& image) {
    Texture texture;
    texture.image = image;
    model.textures.push_back(texture);
    return static_cast<int>(model.textures.size()) - 1;
}

Image uniform_image(std::vector<float> channels) {
    Image image(2, 2, static_cast<int>(channels.size()));
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = channels[i % channels.size()];
    return image;
}

struct Sampled {
    Geometry geometry;
    Surface surface;
    MaterialSample material;
};

Sampled sample(const Model& model, int size = 16) {
    Sampled result;
    result.geometry = Geometry::from_model(model);
    const std::vector<Camera> cameras{front_camera(3, 0.6f)};
    result.surface = interpolate_surface(result.geometry,
                                         rasterize(result.geometry, cameras, size, size), cameras);
    result.material = TexturedMaterials(model).sample(result.surface);
    return result;
}

void expect_rows(const at::Tensor& rows, const std::vector<float>& expected) {
    EXPECT_LT((rows - at::tensor(expected)).abs().max().item<float>(), 1e-4)
        << rows[0] << " instead of " << at::tensor(expected);
}

TEST(SampleTexture, BilinearWithEachWrapMode) {
    // One row of texels 0, 1, 2, 3, whose centres are at u = 1/8, 3/8, 5/8, 7/8.
    const at::Tensor texture = at::arange(4).to(at::kFloat).reshape({1, 4, 1});
    const std::vector<float> u{0.125f, 0.25f, 0.0f, 1.0f, 1.125f, -0.375f, 1.375f, 7.25f};
    const auto values = [&](Wrap wrap) {
        const at::Tensor uv = at::stack({at::tensor(u), at::full({8}, 0.3f)}, 1);
        return sample_texture(texture, uv, wrap, wrap).squeeze(1);
    };
    EXPECT_TRUE(
        at::allclose(values(Wrap::repeat), at::tensor({0.f, .5f, 1.5f, 1.5f, 0.f, 2.f, 1.f, .5f})));
    EXPECT_TRUE(at::allclose(values(Wrap::clamp_to_edge),
                             at::tensor({0.f, .5f, 0.f, 3.f, 3.f, 0.f, 3.f, 3.f})));
    EXPECT_TRUE(at::allclose(values(Wrap::mirrored_repeat),
                             at::tensor({0.f, .5f, 0.f, 3.f, 3.f, 1.f, 2.f, 2.5f})));
}

TEST(SampleTexture, NearestTakesTheTexelItself) {
    const at::Tensor texture = at::arange(4).to(at::kFloat).reshape({1, 4, 1});
    const std::vector<float> u{0.01f, 0.24f, 0.26f, 0.6f, 0.99f, 1.3f, -0.3f, 7.6f};
    const at::Tensor uv = at::stack({at::tensor(u), at::full({8}, 0.3f)}, 1);
    const auto values = [&](Wrap wrap) {
        return sample_texture(texture, uv, wrap, wrap, true).squeeze(1);
    };
    EXPECT_TRUE(
        at::equal(values(Wrap::repeat), at::tensor({0.f, 0.f, 1.f, 2.f, 3.f, 1.f, 2.f, 2.f})));
    EXPECT_TRUE(at::equal(values(Wrap::clamp_to_edge),
                          at::tensor({0.f, 0.f, 1.f, 2.f, 3.f, 3.f, 0.f, 3.f})));
    EXPECT_TRUE(at::equal(values(Wrap::mirrored_repeat),
                          at::tensor({0.f, 0.f, 1.f, 2.f, 3.f, 2.f, 1.f, 1.f})));
}

TEST(SampleTexture, NearestIsForMagnifiedTexelsAlone) {
    const std::vector<at::Tensor> levels = texture_pyramid(at::rand({8, 8, 1}));
    const at::Tensor uv = at::tensor({0.3f, 0.7f}).reshape({1, 2});
    const auto value = [&](float pixel, bool nearest) {
        const at::Tensor footprint = at::tensor({pixel, 0.f, 0.f, pixel}).reshape({1, 4});
        return sample_texture(levels, uv, footprint, Wrap::repeat, Wrap::repeat, nearest)
            .item<float>();
    };
    EXPECT_EQ(value(0.05f, true), levels[0][5][2].item<float>());
    EXPECT_NE(value(0.05f, false), value(0.05f, true));
    EXPECT_EQ(value(0.5f, true), value(0.5f, false));
}

TEST(SampleTexture, GradientOfANearestTexture) {
    at::manual_seed(1);
    const at::Tensor uv = at::randn({50, 2});
    testing::check_gradient(
        [&](const at::Tensor& x) {
            return sample_texture(x, uv, Wrap::repeat, Wrap::repeat, true);
        },
        at::rand({6, 7, 3}), 1e-2f, 1e-4);
}

TEST(SampleTexture, SurvivesAbsurdCoordinates) {
    const at::Tensor texture = at::rand({3, 5, 2});
    const float infinity = std::numeric_limits<float>::infinity();
    const at::Tensor uv =
        at::tensor({1e30f, -1e30f, infinity, -infinity, std::nanf(""), 0.5f, 3e9f, -7e8f})
            .reshape({4, 2});
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        EXPECT_TRUE(at::isfinite(sample_texture(texture, uv, wrap, wrap)).all().item<bool>());
}

TEST(SampleTexture, GradientOfTheTexture) {
    at::manual_seed(1);
    const at::Tensor uv = at::randn({50, 2});
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        testing::check_gradient(
            [&](const at::Tensor& x) { return sample_texture(x, uv, wrap, wrap); },
            at::rand({6, 7, 3}), 1e-2f, 1e-4);
}

TEST(TexturedMaterials, FactorsTexturesAndVertexColoursMultiply) {
    Model model = quad_model();
    Material& material = model.materials[0];
    material.base_color_factor = Vec4(0.5f, 1, 1, 1);
    material.base_color_texture = add_texture(model, uniform_image({0.5f, 1, 0, 1}));
    material.metallic_factor = 0.5f;
    material.roughness_factor = 0.8f;
    material.metallic_roughness_texture = add_texture(model, uniform_image({0, 0.5f, 1}));
    material.occlusion_texture = add_texture(model, uniform_image({0.4f}));
    material.occlusion_strength = 0.5f;
    material.emissive_factor = Vec3(2, 1, 0);
    model.primitives[0].colors.assign(4, Vec4(1, 0.25f, 1, 1));
    const MaterialSample material_sample = sample(model).material;
    expect_rows(material_sample.base_color, {0.5f * srgb_to_linear(0.5f), 0.25f, 0});
    expect_rows(material_sample.orm, {0.7f, 0.4f, 0.5f});
    expect_rows(material_sample.emissive, {2, 1, 0});
    EXPECT_FALSE(material_sample.normal.defined());
    EXPECT_FALSE(material_sample.alpha.defined());
}

TEST(TexturedMaterials, DecodesBeforeFiltering) {
    Model model = quad_model();
    Image image(2, 1, 3);
    for (int c = 0; c < 3; ++c)
        image.at(1, 0, c) = 1;
    model.materials[0].base_color_texture = add_texture(model, image);
    const Sampled sampled = sample(model, 64);
    const at::Tensor u = sampled.surface.uv.select(1, 0);
    const at::Tensor middle = (u > 0.3f).logical_and(u < 0.7f);
    const at::Tensor expected = (u * 2 - 0.5f).masked_select(middle);
    EXPECT_LT((sampled.material.base_color.select(1, 0).masked_select(middle) - expected)
                  .abs()
                  .max()
                  .item<float>(),
              1e-4);
}

TEST(TexturedMaterials, EachPointHasItsOwnMaterial) {
    Model model = quad_model();
    Primitive second = model.primitives[0];
    model.primitives[0].positions = {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}};
    second.positions = {{0, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 1, 0}};
    second.material = 2;
    model.primitives.push_back(second);
    model.materials.resize(3);
    model.materials[0].base_color_factor = Vec4(1, 0, 0, 1);
    model.materials[2].base_color_factor = Vec4(0, 0, 1, 1);
    model.materials[2].normal_texture = add_texture(model, uniform_image({0.5f, 0.5f, 1}));
    const Sampled sampled = sample(model);
    const at::Tensor right = sampled.surface.position.select(1, 0) > 0;
    EXPECT_TRUE(at::equal(sampled.surface.material == 2, right));
    EXPECT_TRUE(at::equal(sampled.surface.primitive == 1, right));
    EXPECT_TRUE(at::equal(sampled.material.base_color.select(1, 2) > 0.5f, right));
    EXPECT_TRUE(at::equal(sampled.material.base_color.select(1, 0) > 0.5f, ~right));
    expect_rows(sampled.material.normal, {0, 0, 1});
}

/// Returns a quad with three UV maps and a texture of a black and a white column. The base colour
/// shows both columns by map 0, the occlusion only the black one by map 1. The emission uses map 2,
/// where u and v are swapped.
Model model_of_two_maps() {
    Model model = quad_model();
    Image columns(2, 1, 3);
    for (int c = 0; c < 3; ++c)
        columns.at(1, 0, c) = 1;
    Material& material = model.materials[0];
    material.base_color_texture = add_texture(model, columns);
    model.textures[0].nearest = true;
    material.occlusion_texture = material.base_color_texture;
    material.occlusion_uvs = 1;
    material.emissive_texture = material.base_color_texture;
    material.emissive_factor = Vec3(1.0f);
    material.emissive_uvs = 2;
    std::vector<Vec2> left = model.primitives[0].uvs, turned = left;
    for (Vec2& uv : left)
        uv.x *= 0.5f;
    for (Vec2& uv : turned)
        uv = Vec2(uv.y, uv.x);
    model.primitives[0].further_uvs = {left, turned};
    return model;
}

TEST(TexturedMaterials, EachTextureLooksAtItsOwnUvMap) {
    const auto expect_maps = [](const Sampled& sampled, const at::Tensor& here) {
        const at::Tensor uv = sampled.surface.uv.index_select(0, here);
        const auto rows = [&](const at::Tensor& values) { return values.index_select(0, here); };
        const at::Tensor right = (uv.select(1, 0) > 0.5f).to(at::kFloat);
        const at::Tensor low = (uv.select(1, 1) > 0.5f).to(at::kFloat);
        EXPECT_TRUE(at::equal(rows(sampled.material.base_color).select(1, 0), right));
        EXPECT_EQ(rows(sampled.material.orm).select(1, 0).abs().max().item<float>(), 0);
        EXPECT_TRUE(at::equal(rows(sampled.material.emissive).select(1, 0), low));
    };
    Model model = model_of_two_maps();
    const Sampled sampled = sample(model);
    EXPECT_EQ(sampled.geometry.further_uvs.size(), 2u);
    expect_maps(sampled, at::arange(sampled.surface.count()));

    // The model also has a primitive with another material and a single map.
    Primitive plain = model.primitives[0];
    plain.further_uvs.clear();
    plain.material = 1;
    for (Vec3& position : plain.positions)
        position.x += 2;
    model.primitives.push_back(plain);
    model.materials.emplace_back();
    const Sampled both = sample(model);
    expect_maps(both, (both.surface.material == 0).nonzero().squeeze(1));
}

TEST(TexturedMaterials, UvMapsHaveFootprintsOfTheirOwn) {
    const Model model = model_of_two_maps();
    Sampled sampled = sample(model);
    const std::vector<Camera> cameras{front_camera(3, 0.6f)};
    const Raster raster = rasterize(sampled.geometry, cameras, 16, 16);
    add_uv_footprints(sampled.geometry, raster, sampled.surface);
    ASSERT_EQ(sampled.surface.further_uv_footprints.size(), 2u);
    const at::Tensor half = sampled.surface.uv_footprint * at::tensor({0.5f, 1.f, 0.5f, 1.f});
    EXPECT_TRUE(at::allclose(sampled.surface.further_uv_footprints[0], half, 1e-4, 1e-6));
}

TEST(TexturedMaterials, TangentsFollowTheUvMapOfTheNormalTexture) {
    Model model = model_of_two_maps();
    model.materials[0].normal_texture = 0;
    model.materials[0].normal_uvs = 2;
    const Geometry turned = Geometry::from_model(model);
    // u of the normal's map grows with v of the first map, which is downwards.
    EXPECT_LT((turned.tangents[0].narrow(0, 0, 3) - at::tensor({0.f, -1.f, 0.f}))
                  .abs()
                  .max()
                  .item<float>(),
              1e-5);
    EXPECT_TRUE(at::equal(turned.uvs[1], at::tensor({1.f, 1.f})));
    EXPECT_TRUE(at::equal(turned.further_uvs[1][3], at::tensor({0.f, 0.f})));
}

TEST(TexturedMaterials, TangentsFollowTheTextureAndGreenPointsUp) {
    // A normal that leans to the right and up in the image leans to +X and +Y.
    Model model = quad_model();
    const Sampled sampled = sample(model);
    expect_rows(sampled.surface.tangent, {1, 0, 0, 1});
    // If u is mirrored, the tangent and the handedness change their signs.
    for (Vec2& uv : model.primitives[0].uvs)
        uv.x = 1 - uv.x;
    expect_rows(sample(model).surface.tangent, {-1, 0, 0, -1});
}

EnvironmentLight white() {
    return prefilter(at::ones({6, 16, 16, 3}));
}

RenderOptions small_image() {
    RenderOptions options;
    options.width = 24;
    options.height = 16;
    return options;
}

TEST(Render, CoverageAndBackground) {
    Model model = quad_model();
    model.materials[0].metallic_factor = 1;
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const std::vector<Camera> cameras{front_camera(5, 0.8f), front_camera(8, 0.8f)};
    RenderOptions options = small_image();
    const at::Tensor open = render(geometry, materials, white(), cameras, options);
    ASSERT_EQ(open.sizes(), (std::vector<std::int64_t>{2, 16, 24, 4}));
    // White metal in a white furnace is premultiplied, so all channels equal the coverage.
    EXPECT_TRUE(at::allclose(open.narrow(3, 0, 3), open.narrow(3, 3, 1).expand({2, 16, 24, 3}),
                             1e-4, 1e-4));
    const double pixels_per_unit = 12 / std::tan(0.4) / 5;
    EXPECT_NEAR(open[0].select(2, 3).sum().item<double>(), std::pow(2 * pixels_per_unit, 2), 0.5);

    options.background = Vec3(0.1f, 0.2f, 0.3f);
    const at::Tensor over = render(geometry, materials, white(), cameras, options);
    EXPECT_TRUE(at::allclose(over.select(3, 3), at::ones({2, 16, 24})));
    const at::Tensor expected =
        open.narrow(3, 0, 3) + (1 - open.narrow(3, 3, 1)) * at::tensor({0.1f, 0.2f, 0.3f});
    EXPECT_TRUE(at::allclose(over.narrow(3, 0, 3), expected, 1e-4, 1e-4));
}

TEST(Render, MaskedAndBlendedLayersShowWhatLiesBehind) {
    // A quad of alpha 0.3 is in front of an opaque quad.
    Model model = quad_model();
    Primitive back = model.primitives[0];
    for (Vec3& position : back.positions)
        position.z = -0.5f;
    back.material = 1;
    model.primitives.push_back(back);
    model.materials.resize(2);
    model.materials[0].base_color_factor = Vec4(1, 1, 1, 0.3f);
    model.materials[0].emissive_factor = Vec3(1, 0, 0);
    model.materials[1].emissive_factor = Vec3(0, 1, 0);
    const EnvironmentLight dark = prefilter(at::zeros({6, 16, 16, 3}));
    const auto centre = [&] {
        const at::Tensor image = render(Geometry::from_model(model), TexturedMaterials(model), dark,
                                        {front_camera(5, 0.5f)}, small_image());
        return image[0][8][12];
    };
    expect_rows(centre().unsqueeze(0), {1, 0, 0, 1});
    model.materials[0].alpha = Material::Alpha::blend;
    expect_rows(centre().unsqueeze(0), {0.3f, 0.7f, 0, 1});
    model.materials[0].alpha = Material::Alpha::mask;
    expect_rows(centre().unsqueeze(0), {0, 1, 0, 1});
    model.materials[0].alpha_cutoff = 0.2f;
    expect_rows(centre().unsqueeze(0), {1, 0, 0, 1});
}

TEST(Render, UnlitMaterialsShowTheirBaseColorInAnyLight) {
    Model model = quad_model();
    model.materials[0].base_color_factor = Vec4(0.2f, 0.4f, 0.6f, 1);
    model.materials[0].unlit = true;
    for (const float radiance : {0.0f, 1.0f, 20.0f}) {
        const EnvironmentLight light = prefilter(at::full({6, 16, 16, 3}, radiance));
        const at::Tensor image = render(Geometry::from_model(model), TexturedMaterials(model),
                                        light, {front_camera(5, 0.5f)}, small_image());
        expect_rows(image[0][8][12].unsqueeze(0), {0.2f, 0.4f, 0.6f, 1});
    }
}

TEST(Render, AViewThatSeesNothingIsEmpty) {
    const Model model = quad_model();
    Camera away = front_camera(3);
    away.camera_to_world[3] = Vec4(0, 0, -3, 1);
    const at::Tensor image = render(Geometry::from_model(model), TexturedMaterials(model), white(),
                                    {away}, small_image());
    EXPECT_EQ(image.abs().max().item<float>(), 0);
}

}  // namespace
}  // namespace item3d
