// Tests of the comparison of materials with reference maps.
#include "item3d/reconstruct/outputs/truth.h"

#include "item3d/core/error.h"
#include "item3d/reconstruct/surface/plain_model.h"
#include "tests/support/reconstruct.h"

namespace item3d {
namespace {

using testing::fresh_folder;

constexpr int edge = 32;

/// Returns a square of one material that fills the middle of the view.
Model square(Vec3 base_color, float roughness, float metallic) {
    Model model;
    Primitive primitive;
    primitive.positions = {Vec3(-0.5f, -0.5f, 0), Vec3(0.5f, -0.5f, 0), Vec3(0.5f, 0.5f, 0),
                           Vec3(-0.5f, 0.5f, 0)};
    primitive.normals.assign(4, Vec3(0, 0, 1));
    primitive.indices = {0, 1, 2, 0, 2, 3};
    primitive.material = 0;
    model.primitives = {primitive};
    Material material;
    material.base_color_factor = Vec4(base_color, 1);
    material.roughness_factor = roughness;
    material.metallic_factor = metallic;
    model.materials = {material};
    return model;
}

TargetView front_view() {
    TargetView view;
    view.name = "./test/r_0";
    view.camera = orbit_camera(Vec3(0), 3, 0, 0, 0.7f);
    view.image = at::ones({1, edge, edge, 4});
    return view;
}

void write_plain(const std::filesystem::path& path, Vec3 value) {
    Image image(edge, edge, 4, 1.0f);
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = value[c];
    save_image(path, image);
}

TEST(MaterialTruth, OneFactorAChannelIsNoError) {
    const auto folder = fresh_folder("truth");
    write_plain(folder / "r_0_albedo.png", Vec3(linear_to_srgb(0.6f), linear_to_srgb(0.2f), 0));
    write_plain(folder / "r_0_orm.png", Vec3(0, 0.25f, 1));
    const MaterialTruth found =
        compare_materials(square(Vec3(0.3f, 0.4f, 0.1f), 0.5f, 0.8f), {front_view()}, folder);
    EXPECT_NEAR(found.base_color_gain.x, 2, 0.02f);
    EXPECT_NEAR(found.base_color_gain.y, 0.5f, 0.01f);
    EXPECT_NEAR(found.base_color_gain.z, 0, 1e-3f);
    EXPECT_GT(found.base_color_psnr, 50);
    EXPECT_EQ(found.metallic_right, 1);
    EXPECT_NEAR(found.roughness_error, 0.25, 0.01);
    ASSERT_EQ(found.views.size(), 1u);
    EXPECT_EQ(found.views[0].material.width, edge);

    const MaterialTruth wrong =
        compare_materials(square(Vec3(0.3f, 0.4f, 0.1f), 0.5f, 0.2f), {front_view()}, folder);
    EXPECT_EQ(wrong.metallic_right, 0);
}

TEST(MaterialTruth, WhatDoesNotFitIsNamed) {
    const auto folder = fresh_folder("truth_bad");
    const Model model = square(Vec3(0.5f), 0.5f, 0);
    EXPECT_THROW(compare_materials(model, {front_view()}, folder), InputError);
    save_image(folder / "r_0_albedo.png", Image(8, 8, 3));
    EXPECT_THROW(compare_materials(model, {front_view()}, folder), InputError);
}

}  // namespace
}  // namespace item3d
