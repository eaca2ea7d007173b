// Tests of an edit's layer: applied again it gives the edit's own bytes, and layers add up.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/outputs/rebake_layer.h"
#include "item3d/layers/layer_field.h"
#include "item3d/layers/layered_model.h"
#include "item3d/layers/source_image.h"
#include "tests/support/edit.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace item3d {
namespace {

class LayersTest : public testing::EditTest {
  protected:
    std::filesystem::path apply(const std::vector<std::string>& layers,
                                const std::string& name = "layered.glb") const {
        LayeredModelRequest request;
        request.model = folder_ / "cube.glb";
        request.output = folder_ / name;
        for (const std::string& layer : layers)
            request.layers.push_back(parse_layer_use((folder_ / layer).string()));
        write_layered_model(request);
        return request.output;
    }
    EditLayer layer_of(const EditRequest& edit) const {
        return load_layer(edit.output / "layer.safetensors");
    }
    static void expect_fields(EditLayer layer) {
        EXPECT_EQ(layer.settings.at("to"), "a blue cube");
        const EditFields fields = get_fields(layer);
        const at::NoGradGuard no_grad;
        const at::Tensor places = at::rand({64, 3}) - 0.5;
        const at::Tensor change =
            fields.field->forward(places).base_color - fields.fitted->forward(places).base_color;
        EXPECT_GT(change.abs().max().item<float>(), 0.0f);
        layer.parameters.pop_back();
        EXPECT_THROW(get_fields(layer), InputError);
    }
    /// Checks that the layers of `a` and of a second edit add up, in either order.
    void expect_layers_add_up(const EditRequest& a) const {
        const EditRequest b = request("b", 1, {{"seed", 5}});
        edit_model(b);
        const auto one = apply({"a:0.3", "b:0.7"}, "one.glb");
        EXPECT_EQ(read_bytes(one), read_bytes(apply({"b:0.7", "a:0.3"}, "two.glb")));
        const std::vector<int> before = base_color_bytes(a.model);
        const std::vector<int> first = base_color_bytes(a.output / "model.glb");
        const std::vector<int> second = base_color_bytes(b.output / "model.glb");
        const std::vector<int> sum = base_color_bytes(one);
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const double exact =
                before[i] + 0.3 * (first[i] - before[i]) + 0.7 * (second[i] - before[i]);
            ASSERT_LE(std::abs(sum[i] - std::clamp(exact, 0.0, 255.0)), 0.501) << i;
        }
    }
    /// Checks the warning about another texture and the error about another size. Changes the
    /// cube's file.
    void expect_others_are_told(const EditRequest& edit) const {
        Model other = load_model(edit.model);
        other.textures.at(0).file = nullptr;
        other.source = nullptr;
        other.textures.at(0).image.pixels.at(0) = 0.5f;
        save_model(edit.model, other);
        ::testing::internal::CaptureStderr();
        apply({"a"});
        EXPECT_NE(::testing::internal::GetCapturedStderr().find("another file"), std::string::npos);
        other.textures.at(0).image = Image(32, 64, 3, 0.5f);
        save_model(edit.model, other);
        try {
            apply({"a"});
            FAIL() << "a layer of a larger texture was applied";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("64 x 64, not 32 x 64"), std::string::npos)
                << error.what();
        }
    }
    std::vector<int> base_color_bytes(const std::filesystem::path& path) const {
        std::vector<int> bytes;
        for (const float value : base_color_of(path).pixels)
            bytes.push_back(to_file_value(value, 8));
        return bytes;
    }
};

TEST_F(LayersTest, ALayerGivesItsEditAgainAndAddsUpWithOthers) {
    const EditRequest edit = request("a", 2);
    edit_model(edit);
    const Bytes edited = read_bytes(edit.output / "model.glb");
    EXPECT_EQ(read_bytes(apply({"a"})), edited);
    const Bytes source = read_bytes(edit.model);
    EXPECT_NE(edited, source);
    EXPECT_EQ(read_bytes(apply({"a:0"})), source);
    EXPECT_EQ(read_bytes(apply({"a:0", "a:1"})), edited);

    // At half strength, colours change by half as much, up to rounding. At double strength they
    // change twice as much, up to the end of the range.
    const std::vector<int> before = base_color_bytes(edit.model);
    const std::vector<int> after = base_color_bytes(edit.output / "model.glb");
    const std::vector<int> half = base_color_bytes(apply({"a:0.5:base_color"}));
    const std::vector<int> twice = base_color_bytes(apply({"a:2"}));
    ASSERT_EQ(half.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        ASSERT_EQ(2 * half[i] - (before[i] + after[i]), (before[i] + after[i]) & 1) << i;
        ASSERT_EQ(twice[i], std::clamp(2 * after[i] - before[i], 0, 255)) << i;
    }
    const Model model = load_model(apply({"a:0.5:base_color"}));
    EXPECT_LT(model.materials.at(0).metallic_roughness_texture, 0);
    expect_fields(layer_of(edit));
    expect_layers_add_up(edit);
    expect_others_are_told(edit);
}

TEST_F(LayersTest, ARegionHasItsMaskAndANewUvMapComesAlong) {
    const EditRequest part = request("part", 1, {{"region", {"box=-1,-1,-1,0,1,1"}}});
    edit_model(part);
    EXPECT_EQ(read_bytes(apply({"part"})), read_bytes(part.output / "model.glb"));
    const LayerImage image = layer_of(part).images.at(0);
    ASSERT_TRUE(image.mask.defined());
    EXPECT_EQ(image.mask.sizes(), at::IntArrayRef({image.height, image.width}));
    ASSERT_TRUE(image.change.defined());
    const at::Tensor mask = image.mask.slice(0, image.y, image.y + image.change.size(0))
                                .slice(1, image.x, image.x + image.change.size(1));
    EXPECT_TRUE(at::all(image.change.index({mask.eq(0)}).eq(0)).item<bool>());

    Model model = load_model(part.model);
    for (Vec2& uv : model.primitives.at(0).uvs)
        uv.x = 0.5f;  // a line, so no point of the surface has a texel of its own
    model.source = nullptr;
    save_model(part.model, model);
    const EditRequest anew = request("anew", 1, {{"uv", "new"}, {"texture_size", 64}});
    edit_model(anew);
    EXPECT_EQ(layer_of(anew).primitives.size(), 1u);
    EXPECT_EQ(read_bytes(apply({"anew"})), read_bytes(anew.output / "model.glb"));
    EXPECT_THROW(apply({"anew", "part"}), InputError);
}

TEST_F(LayersTest, SixteenBitsLossyFormatsAndResamplingAreExact) {
    Model model = load_model(folder_ / "cube.glb");
    model.textures.at(0).bits_per_channel = 16;
    model.textures.at(0).file = nullptr;
    model.source = nullptr;
    model.materials.at(0).base_color_factor = Vec4(0.9f, 1.0f, 0.8f, 1.0f);
    save_model(folder_ / "cube.glb", model);
    edit_model(request("deep", 1));
    EXPECT_EQ(read_bytes(apply({"deep"})), read_bytes(folder_ / "deep" / "model.glb"));
    const EditRequest small =
        request("small", 1, {{"texture_size", 32}, {"texture_format", "jpeg"}});
    edit_model(small);
    EXPECT_TRUE(layer_of(small).images.at(0).source.defined());
    EXPECT_EQ(read_bytes(apply({"small"})), read_bytes(small.output / "model.glb"));
    EXPECT_THROW(apply({"small", "deep"}), InputError);
}

/// Fixture for layers that are baked again from their fields.
class RebakeTest : public LayersTest {
  protected:
    LayeredModelRequest again(const std::string& layer, int texture_size = 0) const {
        LayeredModelRequest request;
        request.model = folder_ / "cube.glb";
        request.output = folder_ / "again.glb";
        request.layers = {parse_layer_use((folder_ / layer).string())};
        request.texture_size = texture_size;
        request.rebake = rebake_layer;
        return request;
    }
    Image base_color_again(const LayeredModelRequest& request) const {
        record_ = write_layered_model(request);
        return base_color_of(request.output);
    }
    /// True if a texel is well inside one of the cube's six sides, which lie in 3 x 2 cells.
    static bool is_covered(const Image& image, int x, int y) {
        const auto from_middle = [](double cells) {
            return std::abs(cells - std::floor(cells) - 0.5);
        };
        return from_middle(3 * (x + 0.5) / image.width) < 0.35 &&
               from_middle(2 * (y + 0.5) / image.height) < 0.35;
    }
    /// Returns the mean difference of covered texels, in steps of 1/255.
    static double apart(const Image& a, const Image& b) {
        if (a.pixels.size() != b.pixels.size()) return 1e9;
        double sum = 0;
        int count = 0;
        for (int y = 0; y < a.height; ++y)
            for (int x = 0; x < a.width; ++x)
                for (int c = 0; c < a.channels && is_covered(a, x, y); ++c, ++count)
                    sum += 255 * std::abs(a.at(x, y, c) - b.at(x, y, c));
        return sum / count;
    }
    static Image changed(const Image& before, Image after) {
        for (std::size_t i = 0; i < after.pixels.size(); ++i)
            after.pixels[i] -= before.pixels.at(i);
        return after;
    }
    static Image halved(const Image& image) {
        Image small(image.width / 2, image.height / 2, image.channels);
        for (int y = 0; y < small.height; ++y)
            for (int x = 0; x < small.width; ++x)
                for (int c = 0; c < image.channels; ++c)
                    small.at(x, y, c) =
                        (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) +
                         image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c)) /
                        4;
        return small;
    }
    mutable nlohmann::json record_;
};

TEST_F(RebakeTest, AtTheSameSizeIsTheEditAndAtTwiceItLooksTheSame) {
    EditRequest edit = request("part", 2,
                               {{"region", {"box=-1,-1,-1,0,1,1"}},
                                {"learning_rate", 0.1},
                                {"fit_steps", 10},
                                {"feather", 4}});
    edit.draws_turntable = false;
    edit_model(edit);
    const Image source = base_color_of(edit.model);
    const Image edited = base_color_of(edit.output / "model.glb");
    EXPECT_GT(apart(source, edited), 1);
    const Image same = base_color_again(again("part", 64));
    // Storage in half precision changes a value by up to one step; a threshold of the bake can
    // amplify that.
    EXPECT_LT(apart(same, edited), 0.1);
    EXPECT_TRUE(record_["layers"][0].contains("baked_because"));
    const Image twice = base_color_again(again("part", 128));
    ASSERT_EQ(twice.width, 128);
    // Compared with the source resampled in the same way, which is an edit of almost no strength.
    const Image unedited = base_color_again(again("part:0.0001", 128));
    EXPECT_LT(apart(changed(halved(unedited), halved(twice)), changed(source, edited)),
              0.1 * apart(source, edited));
    base_color_again(again("part"));
    EXPECT_EQ(read_bytes(folder_ / "again.glb"), read_bytes(edit.output / "model.glb"));
    EXPECT_FALSE(record_["layers"][0].contains("baked_because"));
}

TEST_F(RebakeTest, AnotherUvMapAndALargerTextureAreBakedFromTheField) {
    EditRequest edit = request(
        "part", 2, {{"region", {"box=-1,-1,-1,0,1,1"}}, {"learning_rate", 0.1}, {"fit_steps", 10}});
    edit.draws_turntable = false;
    edit_model(edit);
    const Image source = base_color_of(edit.model);
    const Image edited = base_color_of(edit.output / "model.glb");
    // The texture and the UV map are turned upside down, so each point looks as before.
    const auto flipped = [](Image image) {
        Image turned = image;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < image.channels; ++c)
                    turned.at(x, image.height - 1 - y, c) = image.at(x, y, c);
        return turned;
    };
    Model model = load_model(edit.model);
    for (Vec2& uv : model.primitives.at(0).uvs)
        uv.y = 1 - uv.y;
    model.textures.at(0).image = flipped(source);
    model.textures.at(0).file = nullptr;
    model.source = nullptr;
    save_model(edit.model, model);
    const Image again_flipped = flipped(base_color_again(again("part")));
    EXPECT_NE(record_["layers"][0]["baked_because"].get<std::string>().find("another UV map"),
              std::string::npos);
    EXPECT_LT(apart(again_flipped, edited), 0.1);

    // After the model was moved, the field does not cover it.
    for (Vec3& position : model.primitives.at(0).positions)
        position.x += 1;
    save_model(edit.model, model);
    EXPECT_THROW(base_color_again(again("part")), InputError);
    EditLayer older = layer_of(edit);
    older.channels.reset();
    save_layer(edit.output / "layer.safetensors", older);
    EXPECT_THROW(base_color_again(again("part", 32)), InputError);
}

TEST(LayerUse, IsReadFromItsEnd) {
    EXPECT_EQ(parse_layer_use("a").strength, LayerUse::strength_steps);
    EXPECT_EQ(parse_layer_use("a:-0.5").strength, -LayerUse::strength_steps / 2);
    const LayerUse use = parse_layer_use("b/a.safetensors:2:roughness,metallic");
    EXPECT_EQ(use.layer, "b/a.safetensors");
    EXPECT_TRUE(use.channels.roughness && use.channels.metallic);
    EXPECT_FALSE(use.channels.base_color || use.channels.normal || use.channels.occlusion);
    for (const char* wrong : {"a:nan", "a:inf", "a:2.1", "a:-1.5", "a:", "a:x", "a:1:", "a:1:blue",
                              "a:1:normal,", "a:1 "})
        EXPECT_THROW(parse_layer_use(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace item3d
