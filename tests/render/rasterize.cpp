#include "item3d/render/topology.h"
#include "tests/support/render.h"

#include <omp.h>

namespace item3d {
namespace {

using testing::front_camera;
using testing::make_geometry;
using testing::make_quad;

/// The nearest triangle along the ray of a pixel, by Cramer's rule in double.
struct Hit {
    int triangle = -1;
    double depth = 0, smallest_weight = 1;  ///< the smallest barycentric weight
    double second_depth = 1e30;
};

Hit trace(const Geometry& geometry, const Camera& camera, int x, int y, int width, int height) {
    const Mat4 inverse = glm::inverse(camera.world_to_clip(width, height));
    const glm::dvec4 far = glm::dmat4(inverse) *
                           glm::dvec4((x + 0.5) * 2 / width - 1, 1 - (y + 0.5) * 2 / height, 1, 1);
    const glm::dvec3 origin(camera.position());
    const glm::dvec3 forward(-Vec3(camera.camera_to_world[2]));
    const glm::dvec3 direction = glm::dvec3(far) / far.w - origin;
    const auto positions = geometry.positions.accessor<float, 2>();
    const auto triangles = geometry.triangles.accessor<std::int32_t, 2>();
    Hit hit;
    hit.depth = 1e30;
    for (int t = 0; t < geometry.triangles.size(0); ++t) {
        glm::dvec3 v[3];
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c)
                v[k][c] = positions[triangles[t][k]][c];
        const glm::dvec3 e1 = v[1] - v[0], e2 = v[2] - v[0];
        const glm::dvec3 p = glm::cross(direction, e2);
        const double determinant = glm::dot(e1, p);
        if (std::abs(determinant) < 1e-12) continue;
        const glm::dvec3 s = origin - v[0];
        const double u = glm::dot(s, p) / determinant;
        const glm::dvec3 q = glm::cross(s, e1);
        const double w = glm::dot(direction, q) / determinant;
        const double distance = glm::dot(e2, q) / determinant;
        const double depth = distance * glm::dot(direction, forward);
        if (std::min({u, w, 1 - u - w}) < 0 || depth < camera.near_plane) continue;
        if (depth < hit.depth)
            hit = {t, depth, std::min({u, w, 1 - u - w}), hit.depth};
        else
            hit.second_depth = std::min(hit.second_depth, depth);
    }
    return hit;
}

TEST(Rasterize, AgreesWithRaysOnRandomTrianglesAlsoThroughTheNearPlane) {
    at::manual_seed(5);
    // The triangles are around the camera, so many cross the near plane or are behind it.
    const at::Tensor centres = (at::rand({60, 1, 3}) - 0.5f) * 5;
    const at::Tensor positions =
        (centres + at::randn({60, 3, 3}) * 0.6f).reshape({-1, 3}).contiguous();
    const Geometry geometry = make_geometry(positions, at::arange(180).reshape({60, 3}));
    Camera camera = front_camera(0.7f, 1.3f);
    camera.near_plane = 0.1f;
    constexpr int width = 53, height = 37;
    const Raster raster = rasterize(geometry, {camera}, width, height);
    int covered = 0, differing = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Hit hit = trace(geometry, camera, x, y, width, height);
            const int found = raster.triangle[0][y][x].item<int>();
            covered += hit.triangle >= 0;
            if (found != hit.triangle) {
                ++differing;
                // Results may differ only where edges or two surfaces almost meet.
                EXPECT_TRUE(hit.triangle < 0 || hit.smallest_weight < 1e-4 ||
                            hit.second_depth - hit.depth < 1e-4)
                    << x << ", " << y << ": " << found << " and " << hit.triangle;
            } else if (found >= 0) {
                EXPECT_NEAR(raster.depth[0][y][x].item<float>(), hit.depth, 1e-4 * hit.depth);
            }
        }
    }
    EXPECT_GT(covered, width * height / 3);
    EXPECT_LT(differing, 5);
}

TEST(Rasterize, EveryPixelOfAJitteredSheetIsDrawnExactlyOnce) {
    at::manual_seed(2);
    constexpr int cells = 6, size = 48;
    at::Tensor positions = at::zeros({(cells + 1) * (cells + 1), 3});
    for (int i = 0; i <= cells; ++i)
        for (int j = 0; j <= cells; ++j) {
            const bool border = i == 0 || j == 0 || i == cells || j == cells;
            const at::Tensor jitter = border ? at::zeros({3}) : at::randn({3}) * 0.08f;
            positions[i * (cells + 1) + j] =
                at::tensor({4.0f * j / cells - 2, 4.0f * i / cells - 2, 0.0f}) + jitter;
        }
    // Some pixel centres are exactly on edges and vertices.
    positions[3 * (cells + 1) + 3] = at::zeros({3});
    std::vector<int> indices;
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
            const int a = i * (cells + 1) + j, b = a + cells + 1;
            for (const int index : {a, a + 1, b + 1, a, b + 1, b})
                indices.push_back(index);
        }
    const at::Tensor triangles = at::tensor(indices).reshape({-1, 3});
    // If the size is odd, a pixel's centre is on the middle vertex.
    const std::vector<Camera> cameras{front_camera(3, 0.9f)};
    at::Tensor count = at::zeros({size + 1, size + 1}, at::kInt);
    for (std::int64_t t = 0; t < triangles.size(0); ++t) {
        const Geometry one = make_geometry(positions, triangles.narrow(0, t, 1));
        count += (rasterize(one, cameras, size + 1, size + 1).triangle[0] >= 0).to(at::kInt);
    }
    EXPECT_EQ(count.min().item<int>(), 1);
    EXPECT_EQ(count.max().item<int>(), 1);
}

TEST(Rasterize, SameBytesWhateverTheThreads) {
    at::manual_seed(8);
    const at::Tensor positions = at::randn({300, 3}) * 0.7f;
    const Geometry geometry = make_geometry(positions, at::randint(300, {200, 3}));
    const std::vector<Camera> cameras{front_camera(), front_camera(4, 0.5f)};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const Raster one = rasterize(geometry, cameras, 70, 50);
    omp_set_num_threads(3);
    const Raster three = rasterize(geometry, cameras, 70, 50);
    omp_set_num_threads(threads);
    EXPECT_TRUE(at::equal(one.triangle, three.triangle));
    EXPECT_TRUE(at::equal(one.barycentrics, three.barycentrics));
    EXPECT_TRUE(at::equal(one.depth, three.depth));
}

TEST(Rasterize, PixelsBehindALayerShowTheNextOne) {
    const Geometry near = make_quad(1, 1, 0.5f), far = make_quad(1, 1, -0.5f);
    const Geometry both = make_geometry(at::cat({near.positions, far.positions}),
                                        at::cat({near.triangles, far.triangles + 4}));
    const Raster first = rasterize(both, {front_camera(3, 0.3f)}, 8, 8);
    EXPECT_TRUE(at::allclose(first.depth, at::full_like(first.depth, 2.5f)));
    const Raster second = rasterize(both, {front_camera(3, 0.3f)}, 8, 8, first.depth);
    EXPECT_TRUE(at::allclose(second.depth, at::full_like(second.depth, 3.5f)));
    const Raster third = rasterize(both, {front_camera(3, 0.3f)}, 8, 8, second.depth);
    EXPECT_EQ(third.triangle.max().item<int>(), -1);
}

TEST(Rasterize, NamesTheWantedShape) {
    Geometry geometry = make_quad(1, 1);
    geometry.triangles = geometry.triangles.to(at::kLong);
    try {
        rasterize(geometry, {front_camera()}, 8, 8);
        FAIL();
    } catch (const std::logic_error& error) {
        EXPECT_NE(std::string(error.what()).find("triangles must be a Int"), std::string::npos)
            << error.what();
        EXPECT_NE(std::string(error.what()).find("[*, 3]"), std::string::npos) << error.what();
    }
}

TEST(InterpolateSurface, IsPerspectiveCorrectAndFacesTheViewer) {
    // The floor recedes. Its positions must satisfy its plane's equation and project to their
    // pixels.
    const Geometry geometry = make_geometry(
        at::tensor({-2.f, -1.f, 2.f, 2.f, -1.f, 2.f, 2.f, -1.f, -9.f, -2.f, -1.f, -9.f})
            .reshape({4, 3}),
        at::tensor({0, 1, 2, 0, 2, 3}, at::kLong).reshape({2, 3}));
    const std::vector<Camera> cameras{front_camera(3, 1.0f)};
    constexpr int size = 32;
    const Raster raster = rasterize(geometry, cameras, size, size);
    Geometry upwards = geometry;
    // These normals point away from the viewer above, so they must be flipped.
    upwards.normals = at::tensor({0.0f, -1.0f, 0.0f}).repeat({4, 1});
    const Surface surface = interpolate_surface(upwards, raster, cameras);
    ASSERT_GT(surface.count(), 100);
    const Mat4 to_clip = cameras[0].world_to_clip(size, size);
    for (std::int64_t i = 0; i < surface.count(); ++i) {
        const float* p = surface.position.data_ptr<float>() + 3 * i;
        EXPECT_NEAR(p[1], -1, 1e-5);
        const Vec4 clip = to_clip * Vec4(p[0], p[1], p[2], 1);
        const std::int64_t pixel = surface.pixel[i].item<std::int64_t>();
        EXPECT_NEAR((clip.x / clip.w * 0.5f + 0.5f) * size, pixel % size + 0.5, 2e-3);
        EXPECT_NEAR((0.5f - clip.y / clip.w * 0.5f) * size, pixel / size + 0.5, 2e-3);
        EXPECT_NEAR(raster.depth.view(-1)[pixel].item<float>(), 3 - p[2], 1e-4);
    }
    EXPECT_TRUE(
        at::equal(surface.normal, at::tensor({0.0f, 1.0f, 0.0f}).expand({surface.count(), 3})));
    EXPECT_TRUE(at::allclose(surface.view.norm(2, 1), at::ones({surface.count()})));
    EXPECT_TRUE(at::equal(surface.tangent.select(1, 3), -at::ones({surface.count()})));
}

TEST(InterpolateSurface, GradientsOfPositionsAndNormals) {
    at::manual_seed(1);
    Geometry geometry = make_quad(1.4f, 1.4f);
    geometry.positions = geometry.positions + at::randn({4, 3}) * 0.3f;
    geometry.normals = at::randn({4, 3}) * 0.3f + at::tensor({0.0f, 0.0f, 1.0f});
    const std::vector<Camera> cameras{front_camera(3, 0.4f), front_camera(4, 0.3f)};
    const auto with = [&](const at::Tensor& positions, const at::Tensor& normals) {
        Geometry moved = geometry;
        moved.positions = positions;
        moved.normals = normals;
        return interpolate_surface(moved, rasterize(moved, cameras, 9, 7), cameras);
    };
    testing::check_gradient(
        [&](const at::Tensor& x) {
            const Surface s = with(x, geometry.normals);
            return at::cat({s.position, s.normal, s.view}, 1);
        },
        geometry.positions, 1e-3f, 5e-3);
    testing::check_gradient([&](const at::Tensor& x) { return with(geometry.positions, x).normal; },
                            geometry.normals, 1e-3f, 5e-3);
}

TEST(Topology, FindsNeighboursAcrossSeams) {
    // The two triangles share an edge by position, but not by index. One zero has another sign.
    const at::Tensor positions = at::tensor({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f,  //
                                             1.f, -0.f, 0.f, 0.f, 1.f, -0.f, 1.f, 1.f, 0.f})
                                     .reshape({6, 3});
    const at::Tensor triangles = at::tensor({0, 1, 2, 3, 5, 4}, at::kInt).reshape({2, 3});
    const at::Tensor neighbours = triangle_neighbours(positions, triangles);
    // Corner 0 of triangle 0 is opposite the shared edge. On the other side, corner 1 of triangle 1
    // is opposite it.
    EXPECT_TRUE(
        at::equal(neighbours, at::tensor({4, -1, -1, -1, 0, -1}, at::kInt).reshape({2, 3})));
}

}  // namespace
}  // namespace item3d
