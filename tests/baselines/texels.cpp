// Tests of texel lists, their visibility to cameras, and texels that no view painted.
#include "item3d/baselines/leftovers.h"
#include "item3d/baselines/texel_list.h"
#include "item3d/baselines/texel_view.h"
#include "item3d/render/rasterize.h"
#include "tests/support/baselines.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d::testing {
namespace {

at::Tensor pattern_of(const at::Tensor& uv) {
    return at::stack({uv.select(1, 0), uv.select(1, 1), 0.3 * uv.select(1, 0)}, 1);
}

TEST(TexelList, LooksUpAFunctionOfTheUvsBetweenTexelsToo) {
    const SphereScene sphere(64);
    const TexelList& texels = *sphere.scene.texels;
    EXPECT_GT(texels.count(), 64 * 64 * 9 / 10);
    const at::Tensor values = pattern_of(texels.surface().uv);
    Surface points = texels.surface();
    points.uv = points.uv * 0.8 + 0.1 + 0.003;  // inside the chart, off the texels' centres
    EXPECT_LT(largest_apart(texels.lookup(values, points), pattern_of(points.uv)), 1e-4);
    const at::Tensor nearest = texels.lookup(values, texels.surface(), /*nearest=*/true);
    EXPECT_LT(largest_apart(nearest, values),
              1.0 / 64);  // the value of the texel itself, or of one across a border
}

TEST(TexelList, GivesImagesOfItsSize) {
    const SphereScene sphere(32);
    const TexelList& texels = *sphere.scene.texels;
    const auto images = texels.images(pattern_of(texels.surface().uv));
    ASSERT_EQ(images.size(), 1u);
    const Image& image = images.at(0);
    EXPECT_EQ(image.width, 32);
    EXPECT_NEAR(image.at(20, 9, 0), 20.5 / 32, 1e-5);
    EXPECT_NEAR(image.at(20, 9, 1), 9.5 / 32, 1e-5);
}

TEST(TexelView, SeesWhatTheRayFromTheCameraMeetsFirst) {
    const SphereScene sphere(64);
    const Camera camera = side_view(sphere.scene, {40, 20}).camera;
    const Raster raster = rasterize(sphere.scene.geometry, {camera}, 256, 256);
    const Surface& surface = sphere.scene.texels->surface();
    const TexelView seen = see_texels(surface, camera, raster.depth[0], 0.01f);
    const Vec3 eye = camera.position();
    int agree = 0, visible = 0;
    for (std::int64_t i = 0; i < surface.count(); ++i) {
        Vec3 p, n;
        for (int c = 0; c < 3; ++c) {
            p[c] = surface.position[i][c].item<float>();
            n[c] = surface.normal[i][c].item<float>();
        }
        const float cosine = glm::dot(n, glm::normalize(eye - p));
        const float told = seen.cosine[i].item<float>();
        // On a convex body, all surfaces that face the camera are visible.
        agree += std::abs(told - std::max(0.0f, cosine)) < 1e-3f || std::abs(cosine) < 0.15f;
        visible += told > 0;
        const Vec4 clip = camera.world_to_clip(256, 256) * Vec4(p, 1.0f);
        EXPECT_NEAR(seen.place[i][0].item<float>(), 0.5f + 0.5f * clip.x / clip.w, 1e-4f);
        EXPECT_NEAR(seen.place[i][1].item<float>(), 0.5f - 0.5f * clip.y / clip.w, 1e-4f);
        if (HasFailure()) break;
    }
    EXPECT_EQ(agree, surface.count());
    EXPECT_GT(visible, surface.count() / 4);
}

TEST(TexelView, ASphereBeforeItHidesThePlane) {
    // The camera looks at the plane z = -2, which is behind the unit sphere.
    const SphereScene sphere(16);
    Camera camera = orbit_camera(Vec3(0), 5, 0, 0, 1.2f);
    const Raster raster = rasterize(sphere.scene.geometry, {camera}, 128, 128);
    Surface points;
    points.position = at::tensor({0.0f, 0.0f, -2.0f, 0.0f, 0.0f, 1.0f}).view({2, 3});
    points.normal = at::tensor({0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f}).view({2, 3});
    const TexelView seen = see_texels(points, camera, raster.depth[0], 0.01f);
    EXPECT_EQ(seen.cosine[0].item<float>(), 0);
    EXPECT_NEAR(seen.cosine[1].item<float>(), 1, 1e-4);
}

TEST(TexelView, SamplesImagesBilinearly) {
    at::manual_seed(1);
    const at::Tensor image = at::rand({2, 3, 4});
    const at::Tensor places = at::tensor({0.4f, 0.7f, 0.0f, 1.0f}).view({2, 2});
    const at::Tensor values = sample_image(image, places);
    const auto at = [&](int c, int y, int x) { return image[c][y][x].item<float>(); };
    for (int c = 0; c < 2; ++c) {
        const float x = 0.4f * 4 - 0.5f, y = 0.7f * 3 - 0.5f;  // between columns 1, 2; rows 1, 2
        const float a = x - 1, b = y - 1;
        EXPECT_NEAR(values[0][c].item<float>(),
                    (at(c, 1, 1) * (1 - a) + at(c, 1, 2) * a) * (1 - b) +
                        (at(c, 2, 1) * (1 - a) + at(c, 2, 2) * a) * b,
                    1e-5);
        EXPECT_NEAR(values[1][c].item<float>(), at(c, 2, 0), 1e-6);  // the lower left corner
    }
}

TEST(TexelView, PixelsThatDoNotCountAreLeftOut) {
    const at::Tensor image = at::tensor({1.0f, 5.0f, 2.0f, 6.0f}).view({1, 2, 2});
    const at::Tensor counts = at::tensor({1.0f, 0.0f, 1.0f, 0.0f}).view({1, 2, 2});
    const at::Tensor places = at::tensor({0.5f, 0.5f, 0.9f, 0.5f}).view({2, 2});
    const ImageSample sample = sample_pixels(image, counts, places);
    EXPECT_NEAR(sample.values[0][0].item<float>(), 1.5, 1e-5);  // the left column's mean
    EXPECT_NEAR(sample.share[0].item<float>(), 0.5, 1e-5);
    EXPECT_NEAR(sample.share[1].item<float>(), 0, 1e-5);  // lies only in the right column
}

TEST(Leftovers, KnownTexelsStayAndOthersLieBetweenThem) {
    const SphereScene sphere(32);
    const TexelList& texels = *sphere.scene.texels;
    const at::Tensor colors = pattern_of(texels.surface().uv);
    const at::Tensor known = texels.surface().uv.select(1, 0) < 0.5;
    const at::Tensor spoiled = at::where(known.unsqueeze(1), colors, 7.0);
    const at::Tensor filled = fill_from_neighbours(texels, spoiled, known);
    EXPECT_TRUE(filled.index_select(0, known.nonzero().select(1, 0))
                    .equal(colors.index_select(0, known.nonzero().select(1, 0))));
    EXPECT_LE(filled.max().item<float>(), 1.001f);
    const at::Tensor right = filled.index_select(0, known.logical_not().nonzero().select(1, 0));
    EXPECT_GT(right.select(1, 0).mean().item<float>(), 0.2f);

    const at::Tensor mean = fill_with_mean(spoiled, known);
    EXPECT_TRUE(mean.index_select(0, known.nonzero().select(1, 0))
                    .equal(colors.index_select(0, known.nonzero().select(1, 0))));
    const at::Tensor wanted = colors.index_select(0, known.nonzero().select(1, 0)).mean(0);
    EXPECT_LT(largest_apart(mean.index_select(0, known.logical_not().nonzero().select(1, 0)),
                            wanted.expand_as(right)),
              1e-4);
    EXPECT_TRUE(fill_with_mean(colors, at::zeros_like(known)).equal(colors));
}

}  // namespace
}  // namespace item3d::testing
