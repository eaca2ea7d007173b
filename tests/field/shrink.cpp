// Tests that a new texture has no more texels than its content needs.
#include "item3d/field/bake/shrink.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

constexpr UvWrap repeating{Wrap::repeat, Wrap::repeat};
constexpr UvWrap clamped{Wrap::clamp_to_edge, Wrap::clamp_to_edge};

template <typename F>
Image image_of(int size, F value) {
    Image image(size, size, 1);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            image.at(x, y, 0) = value(x, y);
    return image;
}

TEST(Shrink, APlainColorIsOneTexel) {
    const Image plain =
        shrink(image_of(256, [](int x, int) { return 0.5f + 0.001f * static_cast<float>(x % 2); }),
               repeating);
    EXPECT_EQ(plain.width, 1);
    EXPECT_EQ(plain.height, 1);
    EXPECT_NEAR(plain.at(0, 0, 0), 0.5f, 1e-3f);
}

TEST(Shrink, DetailKeepsItsTexels) {
    const Image lines =
        shrink(image_of(64, [](int x, int) { return x % 2 == 0 ? 0.4f : 0.6f; }), repeating);
    EXPECT_EQ(lines.width, 64);
    const Image speck = shrink(
        image_of(64, [](int x, int y) { return x == 9 && y == 9 ? 1.0f : 0.0f; }), repeating);
    EXPECT_EQ(speck.width, 64);
}

TEST(Shrink, ASlowChangeTakesFewTexels) {
    const Image slope = shrink(
        image_of(
            128,
            [](int x, int) { return 0.5f + 0.2f * std::sin(static_cast<float>(x) * 0.0490874f); }),
        repeating);
    EXPECT_LT(slope.width, 128);
    EXPECT_GT(slope.width, 8);
}

TEST(Shrink, OddSizesStay) {
    EXPECT_EQ(shrink(Image(15, 15, 3), clamped).width, 15);
    EXPECT_EQ(shrink(Image(0, 0, 3), clamped).width, 0);
}

}  // namespace
}  // namespace item3d
