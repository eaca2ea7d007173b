#include "item3d/render/antialias.h"

#include "tests/support/render.h"

#include <array>

namespace item3d {
namespace {

using testing::front_camera;
using testing::make_geometry;
using testing::make_quad;

at::Tensor coverage(const Geometry& geometry, const std::vector<Camera>& cameras, int size) {
    const Raster raster = rasterize(geometry, cameras, size, size);
    return antialias((raster.triangle >= 0).to(at::kFloat).unsqueeze(-1), raster, geometry);
}

TEST(Antialias, CoverageOfAnAxisAlignedQuadIsExact) {
    // At the distance 1 / tan(0.5) and with a field of view of 1, one unit spans 16 pixels.
    constexpr int size = 32;
    const float distance = 1 / std::tan(0.5f);
    // The edges are between pixel centres: 4.3 pixels left of the middle, 6.7 right, 3.2 below, 5.9
    // above.
    Geometry quad = make_quad(1, 1);
    quad.positions =
        at::tensor({-4.3f, -3.2f, 0.f, 6.7f, -3.2f, 0.f, 6.7f, 5.9f, 0.f, -4.3f, 5.9f, 0.f})
            .reshape({4, 3}) /
        16;
    const at::Tensor image = coverage(quad, {front_camera(distance, 1.0f)}, size)[0];
    const auto at = [&](int x, int y) { return image[y][x][0].item<float>(); };
    const int middle = 16;
    EXPECT_NEAR(at(middle - 5, middle), 0.3, 1e-4);  // the pixel spans [-5, -4]
    EXPECT_NEAR(at(middle + 6, middle), 0.7, 1e-4);  // the pixel spans [6, 7]
    EXPECT_NEAR(at(middle, middle + 3), 0.2, 1e-4);
    EXPECT_NEAR(at(middle, middle - 6), 0.9, 1e-4);
    EXPECT_EQ(at(middle, middle), 1);
    EXPECT_EQ(at(1, 1), 0);
    // The inner diagonal is not a silhouette.
    EXPECT_EQ(image.narrow(0, middle - 5, 7).narrow(1, middle - 3, 8).min().item<float>(), 1);
}

TEST(Antialias, AreaOfASlantedTriangleAndOfAFineMesh) {
    constexpr int size = 64;
    const std::vector<Camera> cameras{front_camera(1 / std::tan(0.5f), 1.0f)};
    const Geometry triangle = make_geometry(
        at::tensor({-0.71f, -0.52f, 0.f, 0.83f, -0.31f, 0.f, 0.12f, 0.77f, 0.f}).reshape({3, 3}),
        at::tensor({0, 1, 2}, at::kLong).reshape({1, 3}));
    const double area = 0.5 * (1.54 * 1.29 - 0.83 * 0.21) * (size / 2) * (size / 2);
    // Each edge is blended along one axis, so the sum is the area for any slope.
    EXPECT_NEAR(coverage(triangle, cameras, size).sum().item<double>(), area, 0.5);

    // The sphere's triangles are much smaller than a pixel, and its outline must still be smoothed.
    const Geometry sphere = Geometry::from_model(make_unit_sphere(200, 400));
    const Camera camera = front_camera(4, 0.7f);
    const double radius = 16 / std::tan(0.35) * std::tan(std::asin(0.25));
    const at::Tensor image = coverage(sphere, {camera}, 32);
    EXPECT_NEAR(image.sum().item<double>(), M_PI * radius * radius, 1);
    const at::Tensor soft = (image > 0.02f).logical_and(image < 0.98f);
    EXPECT_GT(soft.sum().item<int>(), 40);
}

TEST(Antialias, CreasesAndSeamsAreNotSilhouettes) {
    // The two quads meet at an edge where each has its own vertices.
    const Geometry folded = make_geometry(
        at::tensor({-1.f, -1.f, -.5f, 0.f, -1.f, 0.f,  0.f, 1.f, 0.f,  -1.f, 1.f, -.5f,  //
                    0.f,  -1.f, 0.f,  1.f, -1.f, -.5f, 1.f, 1.f, -.5f, 0.f,  1.f, 0.f})
            .reshape({8, 3}),
        at::tensor({0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}, at::kLong).reshape({4, 3}));
    const Raster raster = rasterize(folded, {front_camera(3, 0.3f)}, 16, 16);
    ASSERT_GE(raster.triangle.min().item<int>(), 0);
    at::manual_seed(0);
    const at::Tensor image = at::rand({1, 16, 16, 3});
    EXPECT_TRUE(at::equal(antialias(image, raster, folded), image));
}

TEST(Antialias, Gradients) {
    at::manual_seed(4);
    const at::Tensor positions =
        at::tensor({-0.71f, -0.52f, 0.1f, 0.83f, -0.31f, 0.f, 0.12f, 0.77f, -0.2f,  //
                    -0.4f, -0.7f, -1.f, 0.9f, 0.1f, -1.f, 0.5f, 0.9f, -1.f})
            .reshape({6, 3});
    const Geometry geometry =
        make_geometry(positions, at::tensor({0, 1, 2, 3, 4, 5}, at::kLong).reshape({2, 3}));
    const std::vector<Camera> cameras{front_camera(3, 0.8f), front_camera(4, 0.6f)};
    const at::Tensor image = at::rand({2, 24, 24, 3});
    const Raster fixed = rasterize(geometry, cameras, 24, 24);
    testing::check_gradient([&](const at::Tensor& x) { return antialias(x, fixed, geometry); },
                            image, 1e-2f, 1e-4);
    // Visibility must be the same on both sides of a difference. The step is therefore small
    // compared with the distance of the nearest pixel centre from an edge.
    testing::check_gradient(
        [&](const at::Tensor& x) {
            Geometry moved = geometry;
            moved.positions = x;
            Raster raster = rasterize(moved, cameras, 24, 24);
            EXPECT_TRUE(at::equal(raster.triangle, fixed.triangle));
            return antialias(image, raster, moved);
        },
        positions, 2e-5f, 0.03);
}

/// Blends each pair of pixels according to the place between their centres where a single triangle
/// ends.
at::Tensor scalar_antialias(const at::Tensor& image, const std::array<glm::dvec3, 3>& corners,
                            const at::Tensor& covered) {
    const auto height = static_cast<int>(image.size(0)), width = static_cast<int>(image.size(1));
    at::Tensor result = image.to(at::kDouble).clone();
    const at::Tensor exact = image.to(at::kDouble);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const bool vertical : {false, true}) {
                const int other_x = x + (vertical ? 0 : 1), other_y = y + (vertical ? 1 : 0);
                if (other_x >= width || other_y >= height) continue;
                const bool here = covered[y][x].item<bool>(),
                           there = covered[other_y][other_x].item<bool>();
                if (here == there) continue;
                const double from_x = (here ? x : other_x) + 0.5,
                             from_y = (here ? y : other_y) + 0.5;
                const int sign = here ? 1 : -1;
                // u runs along the pair, from the covered centre outwards; v runs across it.
                double exit = -1e30;
                bool along = false;
                for (std::size_t k = 0; k < 3; ++k) {
                    double u[2], v[2];
                    for (std::size_t end = 0; end < 2; ++end) {
                        const glm::dvec3 p = corners[(k + end) % 3];
                        u[end] = sign * (vertical ? p.y - from_y : p.x - from_x);
                        v[end] = vertical ? p.x - from_x : p.y - from_y;
                    }
                    if ((v[0] < 0) == (v[1] < 0)) continue;
                    const double at = u[0] + (u[1] - u[0]) * v[0] / (v[0] - v[1]);
                    if (at <= exit) continue;
                    exit = at;
                    along = std::abs(u[1] - u[0]) < std::abs(v[1] - v[0]);
                }
                if (!along) continue;
                const at::Tensor inside = here ? exact[y][x] : exact[other_y][other_x];
                const at::Tensor outside = here ? exact[other_y][other_x] : exact[y][x];
                const double beyond = exit - 0.5;
                if (beyond > 0)
                    (here ? result[other_y][other_x] : result[y][x]) += beyond * (inside - outside);
                else
                    (here ? result[y][x] : result[other_y][other_x]) +=
                        -beyond * (outside - inside);
            }
    return result;
}

TEST(ScalarAntialias, BlendsPairByPairAcrossATrianglesEdges) {
    constexpr int width = 33, height = 25;
    const Camera camera = front_camera(3, 0.9f);
    const glm::dmat4 to_clip(camera.world_to_clip(width, height));
    at::manual_seed(12);
    for (int i = 0; i < 12; ++i) {
        SCOPED_TRACE(i);
        // The triangle is turned a little each time.
        const at::Tensor angles = at::arange(3) * (2 * pi / 3) + 0.5f * static_cast<float>(i);
        const at::Tensor positions =
            (at::stack({angles.cos(), angles.sin(), at::zeros({3})}, 1) + 0.2f * at::randn({3, 3}))
                .contiguous();
        const Geometry triangle =
            make_geometry(positions, at::tensor({0, 1, 2}, at::kLong).reshape({1, 3}));
        const Raster raster = rasterize(triangle, {camera}, width, height);
        std::array<glm::dvec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* p = positions.data_ptr<float>() + 3 * k;
            const glm::dvec4 clip = to_clip * glm::dvec4(p[0], p[1], p[2], 1);
            corners[k] = glm::dvec3((clip.x / clip.w + 1) * 0.5 * width,
                                    (1 - clip.y / clip.w) * 0.5 * height, 0);
        }
        const at::Tensor image = at::rand({1, height, width, 2});
        const at::Tensor expected = scalar_antialias(image[0], corners, raster.triangle[0] >= 0);
        EXPECT_GT((expected - image[0]).abs().max().item<double>(), 0.05);
        // Projections in float place an edge within 1e-5 of a pixel of its exact place.
        EXPECT_LT((antialias(image, raster, triangle)[0] - expected).abs().max().item<double>(),
                  1e-4);
    }
}

}  // namespace
}  // namespace item3d
