// Tests of edits of a part of the surface: texels outside keep their bits.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/region_choice.h"
#include "item3d/edit/region_views.h"
#include "item3d/region/masks.h"
#include "item3d/scene/sphere.h"
#include "tests/support/edit.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::EditTest;

/// Returns the number of changed texels outside the region, and the fraction of texels inside that
/// changed.
std::pair<std::int64_t, double> changed_texels(const Model& model, const Image& now,
                                               const RegionRequest& request) {
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials textured(model);
    const FieldSpace space(model, {0});
    const Region region(request, {model, geometry, textured, space});
    const Atlas atlas = choose_uvs(model, space, {0}, UvPolicy::keep);
    const Image mask = region_masks(region, model, geometry, atlas, 0).at(0);
    const Image& was = model.textures.at(0).image;
    std::int64_t outside = 0, inside = 0, in_region = 0;
    for (int y = 0; y < was.height; ++y)
        for (int x = 0; x < was.width; ++x) {
            bool is_same = true;
            for (int c = 0; c < 3; ++c)
                is_same = is_same && was.at(x, y, c) == now.at(x, y, c);
            if (mask.at(x, y, 0) == 0) outside += !is_same;
            if (mask.at(x, y, 0) > 0) ++in_region, inside += !is_same;
        }
    return {outside, static_cast<double>(inside) / static_cast<double>(in_region)};
}

TEST_F(EditTest, OutsideARegionNoTexelChanges) {
    const std::string top = "box=-1,0.1,-1,1,1,1";
    const EditRequest edit =
        request("part", 6, {{"region", {top}}, {"feather", 5}, {"learning_rate", 0.05}});
    const nlohmann::json summary = edit_model(edit);
    const auto [outside, inside] = changed_texels(
        load_model(edit.model), base_color_of(edit.output / "model.glb"), {{top}, {}, 5});
    EXPECT_EQ(outside, 0);
    EXPECT_GT(inside, 0.9);
    EXPECT_GT(summary["region"]["outside"]["texels"].get<int>(), 1000);
    EXPECT_EQ(summary["region"]["outside"]["changed"], 0);
    EXPECT_GT(summary["region"]["share"].get<double>(), 0.2);
    EXPECT_LT(summary["region"]["share"].get<double>(), 0.45);
    EXPECT_NE(read_text(edit.output / "report.html").find("Outside the region, 0 of"),
              std::string::npos);
}

TEST_F(EditTest, DecodedTexelsOfAJpegAreKeptToo) {
    Model model = load_model(folder_ / "cube.glb");
    ModelEdit as_jpeg;
    MaterialEdit& material = as_jpeg.materials[0];
    material.base_color = EditedTexture(Image(model.textures[0].image), 8);
    material.base_color.set_coding({ImageEncoding::jpeg, false, 80});
    save_model(folder_ / "jpeg.glb", model, as_jpeg);
    EditRequest edit = request("part", 3, {{"region", {"sphere=0.5,0,0,0.3"}}});
    edit.model = folder_ / "jpeg.glb";
    edit_model(edit);
    const Model source = load_model(edit.model);
    ASSERT_EQ(source.textures.at(0).coding.encoding, ImageEncoding::jpeg);
    const auto [outside, inside] = changed_texels(source, base_color_of(edit.output / "model.glb"),
                                                  {{"sphere=0.5,0,0,0.3"}, {}, 0});
    EXPECT_EQ(outside, 0);
    EXPECT_GT(inside, 0.5);
}

TEST_F(EditTest, ADeviceEditsARegionAsTheCpuDoes) {
    if (!has_device)
        GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with";
    std::vector<Image> colors;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        EditRequest edit = request(device.is_cuda() ? "cuda" : "cpu", 2,
                                   {{"region", {"box=-1,-1,-1,0,1,1"}}, {"feather", 5}});
        edit.device = device;
        EXPECT_EQ(edit_model(edit)["region"]["outside"]["changed"], 0);
        colors.push_back(base_color_of(edit.output / "model.glb"));
    }
    EXPECT_LT(mean_difference(colors[0], colors[1]), 0.01);
}

TEST_F(EditTest, RegionsThatNothingIsInAreRefused) {
    EXPECT_THROW(edit_model(request("out", 1, {{"region", {"sphere=0,0,0,0.2"}}})), InputError);
    EXPECT_THROW(edit_model(request("out", 1, {{"region", {"material=wood"}}})), InputError);
    EXPECT_FALSE(fs::exists(folder_ / "out" / "model.glb"));
}

TEST_F(EditTest, AutoIsWhereTheSentencesDiffer) {
    // An edit without a region would select the colour to be changed. With `auto` the prior
    // selects, and here it finds no difference.
    EXPECT_THROW(
        edit_model(request("out", 1,
                           {{"region", {"auto"}}, {"to", "a red cube"}, {"from", "a red cube"}})),
        InputError);
}

TEST(RegionViews, PartsWhoseNormalsPointInwardsAreSeenFromOutside) {
    const Model model = make_unit_sphere(24, 32);
    const at::Tensor places = at::eye(3);
    const RegionViews views({places, -places}, model, Geometry::from_model(model));
    std::vector<Camera> cameras(16);
    views.take_turns(cameras, 0, 0);
    for (std::size_t i = 0; i < cameras.size(); i += 2)
        EXPECT_GT(glm::length(cameras[i].position()), 1.05f) << i;
}

TEST(RegionChoice, AChangeOfColorIsAboutWhatHasIt) {
    const auto color = [](const char* word, std::vector<float> linear) {
        return nlohmann::json{{"word", word}, {"base_color", linear}};
    };
    const PriorVocabulary vocabulary(
        {{"vocabulary",
          {{"colors", {color("red", {.6f, .01f, .01f}), color("blue", {.01f, .03f, .5f})}}}}},
        "prior.json");
    const auto changed = [&](const char* from, const char* to) {
        EditSettings settings;
        settings.from = from;
        settings.to = to;
        return color_to_change(EditPlan(settings), vocabulary);
    };
    EXPECT_EQ(changed("a red barrel", "a blue barrel"), "red");
    EXPECT_EQ(changed("a blue barrel", "a red barrel"), "blue");
    EXPECT_EQ(changed("a barrel", "a blue barrel"), std::nullopt);
    EXPECT_EQ(changed("a red barrel", "a golden barrel"), std::nullopt);
    EXPECT_EQ(changed("a red barrel", "a blue chair"), std::nullopt);
    EXPECT_EQ(changed("a red barrel", "a red barrel"), std::nullopt);
}

}  // namespace
}  // namespace item3d
