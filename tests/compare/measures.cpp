// Tests of the agreement of views and of baked light, against plain recomputation.
#include "item3d/compare/baked_light.h"
#include "item3d/compare/view_difference.h"
#include "item3d/lighting/environment.h"
#include "item3d/metrics/color.h"
#include "item3d/render/rasterize.h"
#include "tests/support/render.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

Vec3 row_of_colors(const at::Tensor& colors, std::int64_t i) {
    return Vec3(colors[i][0].item<float>(), colors[i][1].item<float>(), colors[i][2].item<float>());
}

TEST(ViewDifference, IsTheMeanOverPointsAndPairs) {
    at::manual_seed(1);
    std::vector<PointColors> views;
    for (int v = 0; v < 3; ++v)
        views.push_back({at::rand({20, 3}), at::rand({20}) > 0.4});
    double sum = 0, count = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = a + 1; b < 3; ++b)
            for (std::int64_t i = 0; i < 20; ++i) {
                if (!views[a].seen[i].item<bool>() || !views[b].seen[i].item<bool>()) continue;
                sum += color_difference(srgb_to_lab(row_of_colors(views[a].colors, i)),
                                        srgb_to_lab(row_of_colors(views[b].colors, i)));
                ++count;
            }
    ASSERT_GT(count, 5);
    EXPECT_NEAR(view_difference(views), sum / count, 1e-3 * sum / count);
    EXPECT_EQ(view_difference({views[0], views[0]}), 0);
    EXPECT_TRUE(std::isnan(view_difference({views[0]})));
}

/// The scene is a square in the plane z = 0 with points on it. A wall hides its right half.
TEST(ViewDifference, PointsTakeTheColourOfThePixelThatSeesThem) {
    const Camera camera = testing::front_camera(3);
    const Geometry square = testing::make_quad(1, 1);
    const Raster raster = rasterize(square, {camera}, 64, 64);
    Surface points;
    points.position = at::tensor({-0.5f, 0.0f, 0.0f, 0.5f, 0.5f, 0.0f}).reshape({2, 3});
    points.normal = at::tensor({0.0f, 0.0f, 1.0f}).repeat({2, 1});
    // The red channel increases to the right, the green one downwards.
    const at::Tensor ramp = (at::arange(64, at::kFloat) + 0.5) / 64;
    const at::Tensor image = at::stack({ramp.unsqueeze(0).expand({64, 64}),
                                        ramp.unsqueeze(1).expand({64, 64}), at::zeros({64, 64})});
    const at::Tensor counts = (raster.depth > 0).to(at::kFloat);
    const PointColors seen = colors_of_points(points, camera, raster.depth[0], image, counts, 1.0);
    const double reach = 3 * std::tan(0.4);
    ASSERT_TRUE(seen.seen.all().item<bool>());
    EXPECT_NEAR(seen.colors[0][0].item<double>(), 0.5 - 0.25 / reach, 1e-3);
    EXPECT_NEAR(seen.colors[0][1].item<double>(), 0.5, 1e-3);
    EXPECT_NEAR(seen.colors[1][0].item<double>(), 0.5 + 0.25 / reach, 1e-3);
    EXPECT_NEAR(seen.colors[1][1].item<double>(), 0.5 - 0.25 / reach, 1e-3);

    const at::Tensor wall = raster.depth[0].clone();
    wall.narrow(1, 32, 32).fill_(1.5);
    const PointColors hidden = colors_of_points(points, camera, wall, image, counts, 1.0);
    EXPECT_TRUE(hidden.seen[0].item<bool>());
    EXPECT_FALSE(hidden.seen[1].item<bool>());
    points.normal = at::tensor({1.0f, 0.0f, 0.1f}).repeat({2, 1});
    EXPECT_FALSE(colors_of_points(points, camera, raster.depth[0], image, counts, 1.0)
                     .seen.any()
                     .item<bool>());
}

/// Returns an environment that is bright above and dark below.
Image light_from_above() {
    Image light(48, 24, 3, 0.1f);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 48; ++x)
            for (int c = 0; c < 3; ++c)
                light.at(x, y, c) = 2.0f;
    return light;
}

TEST(BakedLight, IsTheCorrelationOfLogarithms) {
    at::manual_seed(2);
    constexpr std::int64_t count = 300;
    const Image light = light_from_above();
    const at::Tensor normals = testing::unit_rows(at::randn({count, 3}));
    const at::Tensor before = 0.2 + 0.6 * at::rand({count, 3});
    const at::Tensor shade = at::empty({count, 1});
    std::vector<double> received;
    for (std::int64_t i = 0; i < count; ++i) {
        const Vec3 color = irradiance_over_pi(light, row_of_colors(normals, i));
        shade[i][0] = color.x;
        received.push_back(std::log(0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z));
    }
    EXPECT_NEAR(baked_light(before, before * shade, normals, light), 1, 1e-4);
    EXPECT_NEAR(baked_light(before, 0.3 * before / shade, normals, light), -1, 1e-4);
    EXPECT_EQ(baked_light(before, before, normals, light), 0);
    const at::Tensor unrelated = before * (0.5 + at::rand({count, 1}));
    EXPECT_LT(std::abs(baked_light(before, unrelated, normals, light)), 0.2);

    const at::Tensor after = 0.2 + 0.6 * at::rand({count, 3}) * shade;
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        const auto brightness = [&](const at::Tensor& colors) {
            const Vec3 c = row_of_colors(colors, i);
            return std::log(0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z);
        };
        const double change = brightness(after) - brightness(before);
        const double lit = received[static_cast<std::size_t>(i)];
        x += lit, y += change, xx += lit * lit, yy += change * change, xy += lit * change;
    }
    const double n = count;
    const double expected =
        (xy / n - x / n * y / n) / std::sqrt((xx / n - x / n * x / n) * (yy / n - y / n * y / n));
    EXPECT_NEAR(baked_light(before, after, normals, light), expected, 1e-4);
}

}  // namespace
}  // namespace item3d
