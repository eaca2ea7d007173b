// Tests of each selector on small models.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/metrics/color.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/region/attention_reading.h"
#include "item3d/region/color_selector.h"
#include "item3d/region/feather.h"
#include "item3d/region/patch_vote.h"
#include "item3d/region/region.h"
#include "item3d/region/region_readers.h"
#include "item3d/region/surface_patches.h"
#include "item3d/region/words_selector.h"
#include "item3d/scene/model_view.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns a square from -1 to 1 in the plane z = `depth`. It faces +Z and has texture coordinates
/// from 0 to 1.
Primitive square(float depth, int material) {
    Primitive primitive;
    primitive.material = material;
    primitive.positions = {{-1, -1, depth}, {1, -1, depth}, {1, 1, depth}, {-1, 1, depth}};
    primitive.normals.assign(4, Vec3(0, 0, 1));
    primitive.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    primitive.indices = {0, 1, 2, 0, 2, 3};
    return primitive;
}

/// Returns two squares, of which "front" is before "back". Their left halves are red, the right
/// ones white.
Model two_squares() {
    Model model;
    Image image(64, 64, 3, 1.0f);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = c == 0 ? 0.75f : 0.1f;
    model.textures.push_back({"halves", image});
    Material front, back;
    front.name = "front";
    front.base_color_factor = Vec4(0, 0, 1, 1);
    back.name = "back";
    back.base_color_texture = 0;
    model.materials = {front, back};
    model.primitives = {square(1, 0), square(-1, 1)};
    return model;
}

class RegionTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d-region-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        use(two_squares());
    }
    void TearDown() override { fs::remove_all(folder_); }

    void use(Model model) {
        model_ = std::move(model);
        geometry_ = Geometry::from_model(model_);
        textured_ = std::make_unique<TexturedMaterials>(model_);
        std::vector<int> all;
        for (std::size_t i = 0; i < model_.materials.size(); ++i)
            all.push_back(static_cast<int>(i));
        space_ = std::make_unique<FieldSpace>(model_, all);
    }
    RegionScene scene() const { return {model_, geometry_, *textured_, *space_}; }

    Region region(const std::vector<std::string>& include,
                  const std::vector<std::string>& exclude = {}, float feather = 0) const {
        return Region({include, exclude, feather}, scene());
    }
    /// Returns a region's weight at a point of a square.
    float weight(const Region& region, int square_index, float x, float y) const {
        // Triangle 0 of a square has corners (-1, -1), (1, -1), (1, 1); triangle 1 (-1, -1), (1,
        // 1), (-1, 1).
        const bool is_lower = y <= x;
        const float first = is_lower ? (1 - x) / 2 : (1 - y) / 2;
        const float second = is_lower ? (x - y) / 2 : (x + 1) / 2;
        const at::Tensor triangle = at::full(
            {1}, static_cast<std::int64_t>(2 * square_index + (is_lower ? 0 : 1)), at::kLong);
        const Surface surface =
            surface_at(geometry_, triangle, at::tensor({first, second}).reshape({1, 2}));
        return region.weight(surface).item<float>();
    }
    /// Writes an image with a white rectangle on black and returns its path. The sides of the
    /// rectangle are fractions of the image.
    std::string mask(const std::string& name, float left, float top, float right, float bottom,
                     int size = 64) const {
        Image image(size, size, 1);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
                const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
                if (u > left && u < right && v > top && v < bottom) image.at(x, y, 0) = 1;
            }
        save_image(folder_ / name, image);
        return (folder_ / name).string();
    }
    std::string error_of(const std::string& selector) const {
        try {
            region({selector});
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
    void expect_error(const std::string& selector, const std::string& words) const {
        EXPECT_NE(error_of(selector).find(words), std::string::npos) << error_of(selector);
    }

    fs::path folder_;
    Model model_;
    Geometry geometry_;
    std::unique_ptr<TexturedMaterials> textured_;
    std::unique_ptr<FieldSpace> space_;
};

TEST_F(RegionTest, MaterialsAreTakenWhole) {
    const Region back = region({"material=Back"});  // case does not matter
    EXPECT_EQ(weight(back, 0, 0.1f, 0.2f), 0);
    EXPECT_EQ(weight(back, 1, 0.1f, 0.2f), 1);
    EXPECT_NEAR(back.share(), 0.5, 1e-3);
    EXPECT_EQ(back.materials(), std::vector<int>{1});
    EXPECT_EQ(region({"material=back", "material=front"}).materials(), (std::vector<int>{0, 1}));
    expect_error("material=side", "front");
}

TEST_F(RegionTest, BoxesAndSpheresAreMeasuredInTheModelsUnits) {
    const Region box = region({"box=0,0,2,1,1,0.5"});
    EXPECT_EQ(weight(box, 0, 0.5f, 0.5f), 1);
    EXPECT_EQ(weight(box, 0, -0.5f, 0.5f), 0);
    EXPECT_EQ(weight(box, 1, 0.5f, 0.5f), 0);
    const Region sphere = region({"sphere=0,0,-1,0.5"});
    EXPECT_EQ(weight(sphere, 1, 0.4f, 0.1f), 1);
    EXPECT_EQ(weight(sphere, 1, 0.4f, 0.4f), 0);
    EXPECT_NEAR(sphere.share(), pi * 0.25 / 8, 1e-3);
    expect_error("box=1,2,3", "6 numbers");
    expect_error("box=1,2,3,4,5,x", "6 numbers");
    expect_error("sphere=0,0,0,-1", "above 0");
    expect_error("sphere=9,0,0,1", "the model is between");
}

TEST_F(RegionTest, ExcludedPlacesAreTakenOff) {
    const Region rest = region({}, {"material=front", "sphere=0,0,-1,0.5"});
    EXPECT_EQ(weight(rest, 0, 0, 0), 0);
    EXPECT_EQ(weight(rest, 1, 0, 0), 0);
    EXPECT_EQ(weight(rest, 1, 0.9f, 0), 1);
    EXPECT_THROW(region({"material=back"}, {"material=back"}), InputError);
    EXPECT_THROW(region({"color=#bf1a1a~10"}, {"color=#bf1a1a~10"}), InputError);
}

TEST_F(RegionTest, MasksLieInTheUvMap) {
    const std::string file = mask("quarter.png", 0, 0, 0.5f, 0.5f);
    const Region everywhere = region({"mask=" + file});
    EXPECT_EQ(weight(everywhere, 0, -0.5f, 0.5f), 1);
    EXPECT_EQ(weight(everywhere, 0, 0.5f, 0.5f), 0);
    EXPECT_EQ(weight(everywhere, 1, -0.5f, 0.5f), 1);
    const Region one = region({"mask=" + file + "@back"});
    EXPECT_EQ(weight(one, 0, -0.5f, 0.5f), 0);
    EXPECT_EQ(weight(one, 1, -0.5f, 0.5f), 1);
    expect_error("mask=" + mask("black.png", 0, 0, 0, 0), "white");
    expect_error("mask=" + file + "@side", "front");
    expect_error("mask=/nowhere.png", "/nowhere.png");
}

TEST_F(RegionTest, ViewsPaintWhatTheySee) {
    // From the front, the front square hides the other one. From 180 degrees, the back square hides
    // the front one.
    const std::string file = mask("middle.png", 0.45f, 0.45f, 0.55f, 0.55f);
    const Region front = region({"view=" + file + "@0,0"});
    EXPECT_EQ(weight(front, 0, 0, 0), 1);
    EXPECT_EQ(weight(front, 0, 0.8f, 0), 0);
    EXPECT_EQ(weight(front, 1, 0, 0), 0);
    const Region back = region({"view=" + file + "@180,0"});
    EXPECT_EQ(weight(back, 0, 0, 0), 0);
    EXPECT_EQ(weight(back, 1, 0, 0), 1);
    EXPECT_GT(region({"view=" + file}).share(), 0);
    expect_error("view=" + file + "@front", "2 numbers");
    expect_error("view=" + file + "@/nowhere.json", "/nowhere.json");
}

TEST_F(RegionTest, ColorsAreTheModelsOwn) {
    for (const char* selector : {"color=#bf1a1a~10", "named=red"}) {
        const Region red = region({selector});
        EXPECT_EQ(weight(red, 1, -0.5f, 0.3f), 1) << selector;
        EXPECT_EQ(weight(red, 1, 0.5f, 0.3f), 0) << selector;
        EXPECT_EQ(weight(red, 0, -0.5f, 0.3f), 0) << selector;
        EXPECT_NEAR(red.share(), 0.25, 0.01) << selector;
    }
    EXPECT_EQ(weight(region({"named=white"}), 1, 0.5f, 0.3f), 1);
    expect_error("color=reddish", "reddish");
    expect_error("color=red~0", "above 0");
    expect_error("named=crimson", "purple");
    expect_error("named=yellow", "nothing of the edited materials");
}

TEST(RegionColor, LabIsThatOfTheMetrics) {
    const at::Tensor colors =
        at::tensor({0.2f, 0.5f, 0.9f, 0.0f, 0.0f, 0.0f, 0.004f, 0.001f, 0.0f}).reshape({3, 3});
    const at::Tensor lab = lab_of(colors);
    for (int i = 0; i < 3; ++i) {
        const Lab one = linear_to_lab(Vec3(colors[i][0].item<float>(), colors[i][1].item<float>(),
                                           colors[i][2].item<float>()));
        EXPECT_NEAR(lab[i][0].item<float>(), one.l, 2e-3);
        EXPECT_NEAR(lab[i][1].item<float>(), one.a, 5e-3);
        EXPECT_NEAR(lab[i][2].item<float>(), one.b, 5e-3);
    }
}

TEST_F(RegionTest, FeathersLieWithinTheBorder) {
    const float diagonal = std::sqrt(12.0f);
    const Region soft = region({"box=0,-1,-2,1,1,0"}, {}, 100 * 0.5f / diagonal);
    EXPECT_EQ(weight(soft, 1, -0.05f, 0), 0);
    EXPECT_NEAR(weight(soft, 1, 0.25f, 0), 0.5, 0.03);
    EXPECT_EQ(weight(soft, 1, 0.6f, 0), 1);
    EXPECT_LT(weight(soft, 1, 0.1f, 0), weight(soft, 1, 0.2f, 0));
}

TEST_F(RegionTest, GroupsOfAnObj) {
    write_atomically(folder_ / "parts.obj",
                     std::string_view("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n"
                                      "o chair\ng seat wood\nf 1 2 3\ng back\nf 1 3 4\n"
                                      "o table\nf 1 2 6 5\n"));
    use(load_model(folder_ / "parts.obj"));
    EXPECT_NEAR(region({"group=seat"}).share(), 0.25, 0.01);
    EXPECT_NEAR(region({"group=back"}).share(), 0.75, 0.01);  // "back" continues in the next object
    EXPECT_NEAR(region({"group=chair"}).share(), 0.5, 0.01);
    EXPECT_NEAR(region({"group=Table"}).share(), 0.5, 0.01);
    expect_error("group=leg", "seat");
    expect_error("node=leg", "no node with a name");
}

TEST_F(RegionTest, NodesMeshesAndAttributesOfAGltf) {
    // Three triangles lie side by side. The nodes are "arm" with its child "hand", and "foot". The
    // attribute _GLOVE is 1 on the hand.
    std::string bytes;
    const auto add = [&](float value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
        add(v);
    for (const float v : {1.f, 1.f, 1.f})
        add(v);
    write_atomically(folder_ / "data.bin", std::string_view(bytes));
    write_atomically(folder_ / "parts.gltf",
                     std::string_view(R"({"asset": {"version": "2.0"}, "scene": 0,
          "scenes": [{"nodes": [0, 2]}],
          "nodes": [{"name": "arm", "mesh": 0, "children": [1]},
                    {"name": "hand", "mesh": 1, "translation": [2, 0, 0]},
                    {"name": "foot", "mesh": 2, "translation": [4, 0, 0]}],
          "meshes": [{"name": "Arm", "primitives": [{"attributes": {"POSITION": 0}}]},
                     {"name": "Hand", "primitives": [{"attributes": {"POSITION": 0, "_GLOVE": 1}}]},
                     {"name": "Foot", "primitives": [{"attributes": {"POSITION": 0}}]}],
          "buffers": [{"uri": "data.bin", "byteLength": 48}],
          "bufferViews": [{"buffer": 0, "byteLength": 36},
                          {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
          "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                         "min": [0, 0, 0], "max": [1, 1, 0]},
                        {"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR"}]})"));
    use(load_model(folder_ / "parts.gltf"));
    EXPECT_NEAR(region({"node=hand"}).share(), 1.0 / 3, 0.01);
    EXPECT_NEAR(region({"node=arm"}).share(), 2.0 / 3, 0.01);  // with its descendants
    EXPECT_NEAR(region({"mesh=Foot"}).share(), 1.0 / 3, 0.01);
    EXPECT_NEAR(region({"attribute=_GLOVE"}).share(), 1.0 / 3, 0.01);
    expect_error("node=head", "arm, foot, hand");
    expect_error("attribute=_SHOE", "_GLOVE");
}

TEST_F(RegionTest, PatchesEndAtCreasesAndAtEdgesOfColor) {
    // The model has two squares that share no edge, and a third that stands on the second.
    Model model = two_squares();
    Primitive wall = square(-1, 1);
    wall.positions = {{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}};
    wall.normals.assign(4, Vec3(1, 0, 0));
    wall.uvs.assign(4, Vec2(0.25f, 0.5f));
    model.primitives.push_back(wall);
    use(model);
    const SurfacePatches patches = find_patches(scene());
    ASSERT_EQ(patches.of_triangle.size(), 6u);
    EXPECT_EQ(patches.of_triangle[0], patches.of_triangle[1]);
    EXPECT_NE(patches.of_triangle[0], patches.of_triangle[2]);
    EXPECT_NE(patches.of_triangle[2], patches.of_triangle[4]);
    EXPECT_EQ(patches.of_triangle[4], patches.of_triangle[5]);
}

TEST_F(RegionTest, WordsNeedASegmenterThatSeesThem) {
    expect_error("words=the handle", "--segmenter");
    // The weights are random, so either something is selected or the error says that nothing
    // matches.
    const fs::path folder = fs::path(ITEM3D_TEST_DATA) / "models" / "clip_seg" / "plain";
    const RegionRequest request{{"words=the handle"}, {}, 0};
    const RegionReaders readers = load_readers(request, folder, {}, at::kCPU);
    RegionScene seen = scene();
    seen.readers = &readers;
    try {
        const Region region(request, seen);
        EXPECT_GT(region.share(), 0);
        EXPECT_LE(region.share(), 1);
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("nothing "), std::string::npos) << error.what();
    }
    EXPECT_THROW(load_readers(request, folder_, {}, at::kCPU), InputError);
    EXPECT_EQ(load_readers({{"named=red"}, {}, 0}, folder_, {}, at::kCPU).segmenter, nullptr);
}

TEST_F(RegionTest, AnswersAboutImagesAreGatheredWhereTheyAreSeen) {
    // A small square is inside of a closed cube, where no view sees it.
    Model model = two_squares();
    for (const float side : {-1.0f, 1.0f})
        for (int axis = 0; axis < 2; ++axis) {
            Primitive wall = square(side, 0);
            for (Vec3& p : wall.positions)
                p = axis == 0 ? Vec3(p.z, p.x, p.y) : Vec3(p.x, p.z, p.y);
            wall.normals.assign(4, axis == 0 ? Vec3(side, 0, 0) : Vec3(0, side, 0));
            model.primitives.push_back(wall);
        }
    Primitive inner = square(0, 0);
    for (Vec3& p : inner.positions)
        p *= 0.3f;
    model.primitives.push_back(inner);
    use(model);
    int views = 0;
    const SurfaceReading reading = read_surface(scene(), 48, [&](const ModelView& view) {
        ++views;
        EXPECT_EQ(view.image.size(3), 48);
        // The first prompt matches red pixels, the second matches everywhere.
        const at::Tensor red = (view.image[0][0] - view.image[0][2]).gt(0.3);
        return at::stack({red.to(at::kFloat), at::ones({48, 48})});
    });
    EXPECT_EQ(views, reading_views());
    EXPECT_GE(views, 8);
    const at::Tensor is_inner = reading.triangle.ge(12);
    EXPECT_GT(is_inner.sum().item<std::int64_t>(), 100);
    EXPECT_FALSE(reading.seen.index({is_inner}).any().item<bool>());
    EXPECT_GT(reading.seen.index({is_inner.logical_not()}).to(at::kFloat).mean().item<float>(),
              .9f);
    const at::Tensor back = reading.triangle.ge(2).logical_and(reading.triangle.lt(4));
    const at::Tensor x = reading.position.select(1, 0);
    const at::Tensor left = back.logical_and(x.lt(-0.1)).logical_and(reading.seen);
    const at::Tensor right = back.logical_and(x.gt(0.1)).logical_and(reading.seen);
    EXPECT_GT(reading.values[0].index({left}).mean().item<float>(), 0.8f);
    EXPECT_LT(reading.values[0].index({right}).mean().item<float>(), 0.1f);
    EXPECT_NEAR(reading.values[1].index({reading.seen}).min().item<float>(), 1, 1e-4);
    EXPECT_EQ(reading.values[1].index({is_inner}).max().item<float>(), 0);
}

TEST_F(RegionTest, SmallPatchesAreTakenWholeAndLargeOnesCut) {
    Model model = two_squares();
    model.primitives.push_back(square(3, 0));
    for (Vec3& p : model.primitives.back().positions)
        p = Vec3(0.4f * p.x, 0.4f * p.y, p.z);
    use(model);
    const SurfaceReading reading = read_surface(scene(), 48, [](const ModelView&) {
        return at::ones({1, 4, 4});
    });
    // A third of the large front square is selected, and a third of the small square before it.
    const at::Tensor x = reading.position.select(1, 0), z = reading.position.select(1, 2);
    const at::Tensor is_small = z.gt(2), is_front = z.gt(0).logical_and(z.lt(2));
    const at::Tensor value = is_front.logical_and(x.gt(0.33))
                                 .logical_or(is_small.logical_and(x.gt(0.132)))
                                 .to(at::kFloat);
    const PatchVote vote = vote_by_patch(scene(), reading, value, 0.5f);
    const at::Tensor weights = vote.selector->weight(surface_at(
        geometry_, at::tensor({0, 0, 4, 4, 2}, at::kLong),
        at::tensor({.9f, .05f, .05f, .9f, .9f, .05f, .05f, .9f, .05f, .9f}).view({5, 2})));
    // The weights belong to the left and right of the large square, those of the small one, and the
    // back.
    EXPECT_TRUE(weights.equal(at::tensor({0.0f, 1.0f, 1.0f, 1.0f, 0.0f}))) << weights;
    EXPECT_EQ(vote.mean, 1);
}

TEST_F(RegionTest, AutoNeedsTwoSentencesThatDiffer) {
    expect_error("auto", "--from and --to");
    expect_error("auto=red", "takes no value");
    RegionReaders readers;
    readers.prior = std::make_shared<Pipeline>(
        Pipeline::load(fs::path(ITEM3D_TEST_DATA) / "models" / "pipeline_sd"));
    readers.from = "a red cube";
    readers.to = "a red cube";
    RegionScene asked = scene();
    asked.readers = &readers;
    const auto message = [&](const std::string& selector) {
        try {
            const Region region({{selector}, {}, 0}, asked);
            return std::string(region.share() > 0 ? "taken" : "empty");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
    };
    EXPECT_NE(message("auto").find("reads --from and --to as the same"), std::string::npos);
    // The prior's weights are random, so the difference is about the same everywhere.
    readers.to = "a blue cube";
    const std::string differs = message("auto");
    EXPECT_TRUE(differs == "taken" ||
                differs.find("about the same everywhere") != std::string::npos)
        << differs;
    // If there is no segmenter, the prior finds the words.
    const std::string words = message("words=the handle");
    EXPECT_TRUE(words == "taken" ||
                words.find("the same everywhere on the model") != std::string::npos)
        << words;
}

TEST(RegionWords, AttentionIsComparedWithinThePhrase) {
    EXPECT_EQ(attention_prompt("A Horn"), "the horn");
    EXPECT_EQ(attention_prompt("the red handle"), "the red handle");
    EXPECT_EQ(attention_prompt("anvil"), "the anvil");
    // At one pixel, these are the attention to the start, to "the", "red" and "handle", and to the
    // end.
    const at::Tensor attention = at::tensor({.5f, .1f, .2f, .1f, .1f}).view({5, 1, 1});
    EXPECT_NEAR(share_of_words(attention, 3).item<float>(), .75, 1e-6);
}

TEST(RegionWords, WhatTheVocabularyLacksIsFound) {
    const PriorVocabulary vocabulary({{"words", {"the", "of", "a", "red", "horns", "mug"}}}, "x");
    const auto unknown = [&](const char* phrase) { return unknown_words(vocabulary, phrase); };
    EXPECT_TRUE(unknown("the horn of a mug").all.empty());
    EXPECT_TRUE(unknown("the red part").all.empty());
    EXPECT_TRUE(unknown("the flux capacitor").names_nothing);
    EXPECT_EQ(unknown("the flux capacitor").all, (std::vector<std::string>{"flux", "capacitor"}));
    EXPECT_TRUE(unknown("the red muzzle").names_nothing);
    EXPECT_FALSE(unknown("the dark horns of the cow").names_nothing);
    EXPECT_EQ(unknown("the dark horns of the cow").all, (std::vector<std::string>{"dark", "cow"}));
    EXPECT_TRUE(unknown_words(PriorVocabulary(), "the flux capacitor").all.empty());
}

TEST_F(RegionTest, WhatIsNoSelectorIsTold) {
    expect_error("", "sphere=X,Y,Z,R");
    expect_error("handle", "choose from material=NAME");
    expect_error("material=", "a value is missing");
    expect_error("planet=mars", "choose from");
}

}  // namespace
}  // namespace item3d
