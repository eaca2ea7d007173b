#include "item3d/core/error.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

class Images : public testing::Test {
  protected:
    static Image load(const std::string& name) {
        return load_image(data_folder() / "images" / name);
    }
    Image reference = load("rgb8.png");

    /// Returns the first `channels` channels of the reference, times `scale`.
    Image expected(int channels, float scale = 1.0f) const {
        Image image(reference.width, reference.height, channels);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                for (int c = 0; c < channels; ++c) {
                    image.at(x, y, c) = c == 3 ? 1.0f : reference.at(x, y, c) * scale;
                }
            }
        }
        return image;
    }

    static float largest_difference(const Image& a, const Image& b) {
        float largest = 0.0f;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            largest = std::max(largest, std::abs(a.pixels[i] - b.pixels[i]));
        }
        return largest;
    }
};

// The HDR files hold rgb8 / 64, while the reference's values are rgb8 / 255.
constexpr float hdr_scale = 255.0f / 64.0f;

TEST_F(Images, ReadsEveryKindOfPng) {
    ASSERT_EQ(reference.channels, 3);
    for (const char* name : {"rgb16.png", "adam7.png", "many_idat.png"}) {
        SCOPED_TRACE(name);
        expect_same_image(load(name), reference, 1e-6f);
    }
    for (const char* name : {"gray8.png", "gray16.png"}) {
        SCOPED_TRACE(name);
        expect_same_image(load(name), expected(1), 1e-6f);
    }
    for (const char* name : {"rgba8.png", "rgba16.png"}) {
        SCOPED_TRACE(name);
        Image want = expected(4);
        for (int y = 0; y < want.height; ++y) {
            for (int x = 0; x < want.width; ++x)
                want.at(x, y, 3) = 1.0f - reference.at(x, y, 0);
        }
        expect_same_image(load(name), want, 1e-6f);
    }
    const Image gray_alpha = load("graya8.png");
    ASSERT_EQ(gray_alpha.channels, 2);
    EXPECT_NEAR(gray_alpha.at(3, 2, 1), 1.0f - reference.at(3, 2, 0), 1e-6f);
    EXPECT_EQ(load("palette4.png").channels, 3);
    EXPECT_LT(largest_difference(load("palette4.png"), reference), 0.35f);
    EXPECT_EQ(load("palette_trns.png").channels, 4);
    const Image bits = load("bit1.png");
    ASSERT_EQ(bits.channels, 1);
    for (const float value : bits.pixels)
        EXPECT_TRUE(value == 0.0f || value == 1.0f);
    EXPECT_EQ(load("one_pixel.png").width, 1);
    EXPECT_EQ(load("thin.png").width, 100 * reference.width);
}

TEST_F(Images, ReadsJpeg) {
    expect_same_image(load("baseline.jpg"), reference, 6.5f / 255.0f);
    EXPECT_EQ(load("progressive_420.jpg").channels, 3);
    expect_same_image(load("gray.jpg"), expected(1), 6.5f / 255.0f);
}

TEST_F(Images, ReadsRadiance) {
    // RGBE stores 8 bits of the largest channel, here for values up to 4.
    const float step = 4.0f / 128.0f;
    const Image flat = load("flat.hdr");
    expect_same_image(flat, expected(3, hdr_scale), step);
    expect_same_image(load("flipped_y.hdr"), flat);
    expect_same_image(load("rle.hdr"), flat);
    Image half = flat;
    for (float& value : half.pixels)
        value /= 2.0f;
    expect_same_image(load("exposure.hdr"), half);
}

TEST_F(Images, ReadsEveryKindOfOpenExr) {
    for (const char* name : {"half_zip.exr", "half_piz.exr", "half_none.exr", "float_zips.exr",
                             "float_rle.exr", "float_pxr24.exr"}) {
        SCOPED_TRACE(name);
        expect_same_image(load(name), expected(3, hdr_scale), 2e-3f);
    }
    expect_same_image(load("half_b44.exr"), expected(3, hdr_scale), 0.25f);
    expect_same_image(load("luma_only.exr"), expected(1, hdr_scale), 1e-6f);
    expect_same_image(load("extra_channels.exr"), expected(4, hdr_scale), 2e-3f);
}

TEST_F(Images, WritesWhatItReads) {
    const fs::path folder = fresh_folder("images");
    for (const int channels : {1, 2, 3, 4}) {
        SCOPED_TRACE(channels);
        const Image image = checkered_image(31, 9, channels);
        save_image(folder / "8.png", image);
        expect_same_image(load_image(folder / "8.png"), image, 1e-7f);
        save_image(folder / "16.png", image, 16);
        expect_same_image(load_image(folder / "16.png"), image, 1e-5f);
        Image wide = image;
        for (float& value : wide.pixels)
            value = value * 300.0f - 20.0f;
        save_image(folder / "f.exr", wide);
        expect_same_image(load_image(folder / "f.exr"), wide);
        save_image(folder / "h.exr", wide, 16);
        expect_same_image(load_image(folder / "h.exr"), wide, 0.13f);
    }
    Image radiance = checkered_image(40, 5, 3);
    for (float& value : radiance.pixels)
        value *= 12.0f;
    save_image(folder / "a.hdr", radiance);
    expect_same_image(load_image(folder / "a.hdr"), radiance, 12.0f / 256.0f);
    const Image smooth(32, 16, 3, 0.5f);
    save_image(folder / "a.jpg", smooth);
    expect_same_image(load_image(folder / "a.jpg"), smooth, 2.0f / 255.0f);
    EXPECT_THROW(save_image(folder / "a.bmp", smooth), InputError);
}

TEST_F(Images, WritesValuesThatNoPngHolds) {
    const fs::path folder = fresh_folder("image_values");
    Image image(3, 1, 1);
    image.pixels = {std::nanf(""), 7.0f, -3.0f};
    save_image(folder / "a.png", image);
    EXPECT_EQ(load_image(folder / "a.png").pixels, (std::vector<float>{0.0f, 1.0f, 0.0f}));
    image.pixels = {std::nanf(""), INFINITY, -3.0f};
    save_image(folder / "a.hdr", image);
    for (const float value : load_image(folder / "a.hdr").pixels)
        EXPECT_TRUE(std::isfinite(value));
}

TEST_F(Images, ReadsOrientationsByColumns) {
    const fs::path folder = fresh_folder("image_columns");
    // The file stores two columns of three pixels. The right column comes first, and columns go
    // upwards.
    std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-X 2 +Y 3\n";
    for (int i = 0; i < 6; ++i) {
        text += std::string{static_cast<char>(10 * i + 10), 0, 0, static_cast<char>(136)};
    }
    write_atomically(folder / "a.hdr", text);
    const Image image = load_image(folder / "a.hdr");
    ASSERT_EQ(image.width, 2);
    ASSERT_EQ(image.height, 3);
    EXPECT_EQ(image.at(1, 2, 0), 10.0f);
    EXPECT_EQ(image.at(1, 0, 0), 30.0f);
    EXPECT_EQ(image.at(0, 2, 0), 40.0f);
}

}  // namespace
}  // namespace item3d
