#include "item3d/field/bake/painted_color.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

Image two_columns() {
    Image image(2, 1, 3);
    for (int c = 0; c < 3; ++c) {
        image.at(0, 0, c) = 0.2f;
        image.at(1, 0, c) = 0.8f + 0.2f * static_cast<float>(c);
    }
    return image;
}

TEST(PaintedColor, OfATextureOfItsSizeIsTheTexelsOwn) {
    const Image image = two_columns();
    EXPECT_EQ(color_at_texel(image, 0, 0, {2, 1}), Vec3(0.2f));
    EXPECT_NEAR(color_at_texel(image, 1, 0, {2, 1}).x, 0.8f, 1e-6f);
    EXPECT_EQ(color_at_texel(image, 1, 0, {2, 1}).z, 1.0f);  // 1.2, clamped
}

TEST(PaintedColor, OfALargerTextureIsBilinear) {
    const Image image = two_columns();
    // The image is two texels wide and the texture four. If the centres of the image's texels are
    // at 0 and 1, those of the texture's texels are at -0.25, 0.25, 0.75 and 1.25.
    EXPECT_NEAR(color_at_texel(image, 0, 0, {4, 2}).x, 0.2f, 1e-6f);
    EXPECT_NEAR(color_at_texel(image, 1, 1, {4, 2}).x, 0.2f + 0.25f * 0.6f, 1e-6f);
    EXPECT_NEAR(color_at_texel(image, 2, 0, {4, 2}).x, 0.2f + 0.75f * 0.6f, 1e-6f);
    EXPECT_NEAR(color_at_texel(image, 3, 1, {4, 2}).x, 0.8f, 1e-6f);
}

}  // namespace
}  // namespace item3d
