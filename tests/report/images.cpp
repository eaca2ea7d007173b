#include "item3d/report/animation.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"

#include <gtest/gtest.h>
#include <webp/demux.h>

#include <cmath>

namespace item3d {
namespace {

Image plain(int width, int height, Vec3 color) {
    Image image(width, height, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = color[i % 3];
    return image;
}

TEST(ToDisplay, DividesByAlphaOrComposesInLinearLight) {
    Image linear(3, 1, 4);
    linear.pixels = {0.25f, 0.25f, 0.25f, 0.5f, 0, 0, 0, 0, 9, 9, 9, 1};
    const Image straight = to_display(linear);
    ASSERT_EQ(straight.channels, 4);
    EXPECT_NEAR(straight.at(0, 0, 0), linear_to_srgb(0.5f), 1e-6);
    EXPECT_EQ(straight.at(0, 0, 3), 0.5f);
    EXPECT_EQ(straight.at(1, 0, 0), 0);
    EXPECT_FLOAT_EQ(straight.at(2, 0, 1), 1);
    const Image over = to_display(linear, Vec3(1, 0, 0));
    ASSERT_EQ(over.channels, 3);
    EXPECT_NEAR(over.at(0, 0, 0), linear_to_srgb(0.75f), 1e-6);
    EXPECT_NEAR(over.at(0, 0, 1), linear_to_srgb(0.25f), 1e-6);
    EXPECT_FLOAT_EQ(over.at(1, 0, 0), 1);
    // Straight alpha over the same colour gives the same image.
    const Image again = flatten(straight, Vec3(1, 0, 0));
    for (int x = 0; x < 2; ++x) {
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(again.at(x, 0, c), over.at(x, 0, c), 1e-5);
    }
}

TEST(Resize, KeepsTheMeanAndConstants) {
    Image image(13, 9, 1);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = (i * 37 % 19) / 19.0f;
    const auto mean = [](const Image& picture) {
        double sum = 0;
        for (const float value : picture.pixels)
            sum += value;
        return sum / static_cast<double>(picture.pixels.size());
    };
    EXPECT_NEAR(mean(resize(image, 5, 4)), mean(image), 1e-6);
    EXPECT_EQ(resize(image, 13, 9).pixels, image.pixels);
    for (const auto& [width, height] : {std::pair(40, 3), std::pair(2, 50), std::pair(1, 1)}) {
        const Image constant = resize(plain(13, 9, Vec3(0.25f)), width, height);
        ASSERT_EQ(constant.width, width);
        for (const float value : constant.pixels)
            EXPECT_NEAR(value, 0.25f, 1e-6);
    }
    // Enlarging is linear between pixel centres.
    Image ramp(2, 1, 1);
    ramp.pixels = {0, 1};
    const Image wide = resize(ramp, 8, 1);
    EXPECT_NEAR(wide.at(0, 0, 0), 0, 1e-6);
    EXPECT_NEAR(wide.at(3, 0, 0), 0.375f, 1e-6);
    EXPECT_NEAR(wide.at(4, 0, 0), 0.625f, 1e-6);
    EXPECT_EQ(thumbnail(plain(100, 50, Vec3(0)), 10).height, 5);
    EXPECT_EQ(thumbnail(plain(8, 4, Vec3(0)), 10).width, 8);
}

TEST(ContactSheet, PlacesImagesAndWritesLabels) {
    ContactSheetOptions options;
    options.columns = 2;
    options.gap = 10;
    const std::vector<Tile> tiles = {
        {plain(40, 30, Vec3(1, 0, 0)), "red"},
        {plain(20, 15, Vec3(0, 1, 0)), "gr\xc3\xbcn, and a long label"},
        {Image(), "missing"}};
    const Image sheet = contact_sheet(tiles, options);
    ASSERT_EQ(sheet.width, 2 * 40 + 3 * 10);
    EXPECT_EQ(sheet.at(30, 25, 0), 1);
    EXPECT_EQ(sheet.at(30, 25, 1), 0);
    EXPECT_NEAR(sheet.at(80, 25, 1), 1, 1e-5);  // the smaller image was scaled to fit
    int inked = 0;
    for (int y = 41; y < 56; ++y) {
        for (int x = 10; x < 50; ++x)
            inked += sheet.at(x, y, 0) < 0.5f;
    }
    EXPECT_GT(inked, 20);
    // Each label stays within its tile.
    for (int y = 41; y < 56; ++y)
        EXPECT_NEAR(sheet.at(104, y, 0), options.paper.x, 1e-6);
}

TEST(Text, IsAsWideAsItSays) {
    const std::string text = "Fox {jumps} 09";
    Image image(400, 60, 3, 1.0f);
    draw_text(image, 5, 6, text, Vec3(0), 3);
    int right = 0;
    int bottom = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (image.at(x, y, 0) == 0) {
                right = std::max(right, x);
                bottom = std::max(bottom, y);
            }
        }
    }
    EXPECT_LE(right, 5 + text_width(text, 3));
    EXPECT_GT(right, 5 + text_width(text, 3) - 12);
    EXPECT_LE(bottom, 6 + text_height(3));
    // Nothing is written outside of the image.
    draw_text(image, 390, 55, text, Vec3(0), 3);
    draw_text(image, -20, -5, text, Vec3(0), 3);
}

TEST(Animation, HoldsEveryFrameForItsTime) {
    std::vector<Image> frames;
    for (int i = 0; i < 5; ++i)
        frames.push_back(plain(32, 24, Vec3(0.2f * i, 0.5f, 0.1f)));
    AnimationOptions options;
    options.frames_per_second = 10;
    const Bytes bytes = encode_animation(frames, options);
    EXPECT_EQ(bytes, encode_animation(frames, options));

    WebPData data{bytes.data(), bytes.size()};
    WebPAnimDecoder* decoder = WebPAnimDecoderNew(&data, nullptr);
    ASSERT_NE(decoder, nullptr);
    WebPAnimInfo info;
    WebPAnimDecoderGetInfo(decoder, &info);
    EXPECT_EQ(info.frame_count, 5u);
    EXPECT_EQ(info.canvas_width, 32u);
    EXPECT_EQ(info.loop_count, 0u);
    std::uint8_t* pixels = nullptr;
    int time = 0;
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(WebPAnimDecoderGetNext(decoder, &pixels, &time));
        EXPECT_EQ(time, 100 * (i + 1));
        EXPECT_NEAR(pixels[4 * (12 * 32 + 16)], 255 * 0.2 * i, 10) << i;
    }
    WebPAnimDecoderDelete(decoder);
}

TEST(Webp, StillImagesKeepAlpha) {
    Image image(16, 16, 4, 0.5f);
    image.at(3, 4, 3) = 0;
    const Bytes bytes = encode_webp(image, 100);
    int width = 0;
    int height = 0;
    std::uint8_t* pixels = WebPDecodeRGBA(bytes.data(), bytes.size(), &width, &height);
    ASSERT_NE(pixels, nullptr);
    EXPECT_EQ(width, 16);
    EXPECT_EQ(pixels[4 * (4 * 16 + 3) + 3], 0);
    EXPECT_EQ(pixels[3], 128);
    EXPECT_EQ(pixels[0], 128);
    WebPFree(pixels);
}

}  // namespace
}  // namespace item3d
