// Tests of baking for materials whose textures use different UV maps.
#include "item3d/core/progress.h"
#include "item3d/field/bake/bake.h"
#include "item3d/field/fit.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace item3d {
namespace {

using testing::make_model;
using testing::make_quad;

/// Fits a field, changes all of its outputs slightly, and bakes it.
MaterialEdit moved_and_baked(const Model& model, BakeOptions options) {
    set_verbosity(Verbosity::quiet);
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const FieldSpace space(model, {0});
    const Atlas atlas = make_atlas(model, space, {0}, 64);
    EXPECT_TRUE(atlas.sets.at(0).is_own());
    NeuralTextureOptions field_options;
    field_options.levels = 4;
    field_options.log2_table_size = 12;
    field_options.base_resolution = 8;
    field_options.finest_resolution = 32;
    field_options.bounds = space.bounds();
    NeuralTexture field(field_options);
    FitOptions fit;
    fit.steps = 150;
    fit.batch = 2048;
    fit.show_progress = false;
    fit_to_materials(field, geometry, space, materials, fit);
    NeuralTexture before = snapshot(field);
    {
        const at::NoGradGuard no_grad;
        for (const at::Tensor& parameter : field->network_parameters())
            parameter.mul_(1.01);
    }
    options.show_progress = false;
    return bake({model, geometry, materials, space, atlas}, before, field, options).materials.at(0);
}

TEST(BakeUvMaps, LeavesKeptOcclusionOfAnotherUvMapInItsOwnImage) {
    Model model = make_model(make_quad());
    std::vector<Vec2> turned = model.primitives[0].uvs;
    for (Vec2& uv : turned)
        uv = Vec2(uv.y, uv.x);
    model.primitives[0].further_uvs = {turned};
    ASSERT_GE(model.materials[0].occlusion_texture, 0);
    model.materials[0].occlusion_uvs = 1;
    const MaterialEdit edit = moved_and_baked(model, BakeOptions());
    EXPECT_TRUE(edit.keeps_occlusion);
    for (std::size_t i = 0; i < edit.metallic_roughness->pixels.size(); i += 3) {
        ASSERT_EQ(edit.metallic_roughness->pixels[i], 1.0f);
    }
}

TEST(BakeUvMaps, BringsNormalsOfAnotherUvMapIntoThatOfTheBaseColour) {
    // The normal texture has its own UV map, which is rotated by a quarter turn: its u increases
    // where v of the base colour's map decreases.
    Model model = make_model(make_quad());
    std::vector<Vec2> turned = model.primitives[0].uvs;
    for (Vec2& uv : turned)
        uv = Vec2(1.0f - uv.y, uv.x);
    model.primitives[0].further_uvs = {turned};
    Texture leaning;
    leaning.image = Image(8, 8, 3);
    for (int i = 0; i < 64; ++i) {
        const float normal[3] = {0.8f, 0.5f, 0.9f};
        std::copy_n(normal, 3, &leaning.image.pixels[static_cast<std::size_t>(3 * i)]);
    }
    model.textures.push_back(leaning);
    Material& material = model.materials[0];
    material.normal_texture = static_cast<int>(model.textures.size()) - 1;
    material.normal_uvs = 1;
    BakeOptions options;
    options.channels.normal = true;
    const MaterialEdit edit = moved_and_baked(model, options);
    ASSERT_TRUE(edit.normal);
    const std::size_t middle = static_cast<std::size_t>(
        3 * (edit.normal->width * (edit.normal->height / 2) + edit.normal->width / 2));
    // A normal that leans along u of its old map leans up, which is +Y of the new tangent space.
    EXPECT_NEAR(edit.normal->pixels[middle], 0.5f, 0.1f);
    EXPECT_GT(edit.normal->pixels[middle + 1], 0.7f);
}

}  // namespace
}  // namespace item3d
