// Tests of the light that surfaces receive from each other, against view factors in closed form.

#include "item3d/render/occlusion/indirect_light.h"
#include "item3d/render/occlusion/occlusion.h"
#include "tests/support/render.h"

#include <cmath>

namespace item3d {
namespace {

using testing::check_gradient;
using testing::front_camera;
using testing::make_geometry;

/// Returns a floor at z = 0 before the camera, and on it a wall of the given height at x = 0.
Geometry floor_and_wall(float height) {
    constexpr float far = 30;
    Geometry geometry = make_geometry(
        at::tensor({0.001f, -far, 0.0f, far,  -far, 0.0f, far,  far, 0.0f,   0.001f, far,  0.0f,
                    0.0f,   -far, 0.0f, 0.0f, far,  0.0f, 0.0f, far, height, 0.0f,   -far, height})
            .reshape({8, 3}),
        at::tensor({0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}, at::kLong).reshape({4, 3}));
    geometry.normals.narrow(0, 4, 4).copy_(at::tensor({1.0f, 0.0f, 0.0f}).expand({4, 3}));
    return geometry;
}

/// Returns the indirect light of a wall that has `radiance` on a floor that has none.
IndirectLight bright_wall(const Geometry& geometry, float radiance) {
    IndirectLight indirect(geometry, nullptr, {.rays = 256, .bounces = 1, .spacing = 0.002f});
    indirect.update([&](const Raster&, const Surface& surface, const at::Tensor&) {
        const at::Tensor wall = (surface.position.select(1, 0) < 0.0005f).to(at::kFloat);
        return (radiance * wall).unsqueeze(1).expand({-1, 3}).contiguous();
    });
    return indirect;
}

struct SeenFloor {
    Raster raster;
    Surface surface;
};

SeenFloor look_at_floor(const Geometry& geometry) {
    Camera camera = front_camera(6);
    camera.camera_to_world[3] = Vec4(1.5f, 0, 6, 1);
    SeenFloor seen;
    seen.raster = rasterize(geometry, {camera}, 32, 32);
    seen.surface = interpolate_surface(geometry, seen.raster, {camera});
    return seen;
}

TEST(IndirectLight, BouncesByTheViewFactorOfAWall) {
    const Geometry geometry = floor_and_wall(2);
    const SeenFloor seen = look_at_floor(geometry);
    const at::Tensor bounce = bright_wall(geometry, 3).bounce(seen.raster, seen.surface);
    int checked = 0;
    for (std::int64_t i = 0; i < seen.surface.count(); ++i) {
        const float x = seen.surface.position[i][0].item<float>();
        if (x < 0.4f || x > 3) continue;
        const float expected = 3 * 0.5f * (1 - x / std::sqrt(x * x + 4));
        EXPECT_NEAR(bounce[i][1].item<float>(), expected, 0.15f) << x;
        ++checked;
    }
    EXPECT_GT(checked, 100);
}

/// Tests a mirrored wall. `sunk` is how far all surfaces moved down after the light was stored, as
/// surfaces move in an optimisation.
void expect_mirrored_wall(float sunk) {
    const Geometry geometry = floor_and_wall(2);
    Geometry now = geometry;
    now.positions = geometry.positions - at::tensor({0.0f, 0.0f, sunk});
    SeenFloor seen = look_at_floor(now);
    // From the right, at 45 degrees, the floor reflects the wall up to x = 2.
    const at::Tensor view = at::tensor({std::sqrt(0.5f), 0.0f, std::sqrt(0.5f)});
    seen.surface.view = view.expand({seen.surface.count(), 3}).contiguous();
    const IndirectLight indirect = bright_wall(geometry, 3);
    const at::Tensor smooth = at::full({seen.surface.count(), 1}, 0.01f);
    const auto reflection = indirect.reflect(seen.raster, seen.surface, smooth, 4, 7);
    for (std::int64_t i = 0; i < seen.surface.count(); ++i) {
        const float x = seen.surface.position[i][0].item<float>();
        if (x < 0.05f || std::abs(x - 2) < 0.05f) continue;
        EXPECT_NEAR(reflection.open[i].item<float>(), x < 2 ? 0 : 1, 1e-6f) << x;
        EXPECT_NEAR(reflection.radiance[i][0].item<float>(), x < 2 ? 3 : 0, 1e-4f) << x;
    }
}

TEST(IndirectLight, ASmoothFloorMirrorsTheWallWhereTheMirroredRayMeetsIt) {
    expect_mirrored_wall(0);
}

TEST(IndirectLight, ASurfaceThatHasMovedSinceDoesNotMirrorItself) {
    expect_mirrored_wall(0.01f);
    expect_mirrored_wall(-0.01f);
}

TEST(IndirectLight, NothingChangesWhereNothingIsInTheWay) {
    const at::NoGradGuard no_gradient;
    const Geometry geometry = floor_and_wall(2);
    const SeenFloor seen = look_at_floor(geometry);
    const std::int64_t count = seen.surface.count();
    MaterialSample material;
    material.base_color = at::rand({count, 3});
    material.orm = at::rand({count, 3});
    const EnvironmentLight light = prefilter(at::rand({6, 16, 16, 3}));
    material.orm.select(1, 0).fill_(1.0f);
    const at::Tensor plain = shade(seen.surface, material, light);
    const at::Tensor same = shade_indirect(seen.surface, material, light, at::zeros({count, 3}),
                                           {at::zeros({count, 3}), at::ones({count, 1})});
    EXPECT_LT((plain - same).abs().max().item<float>(), 1e-5f);
}

TEST(IndirectLight, StoredLightComesBack) {
    const Geometry geometry = floor_and_wall(2);
    const SeenFloor seen = look_at_floor(geometry);
    const IndirectLight first = bright_wall(geometry, 2);
    IndirectLight second(geometry, nullptr, {.rays = 256, .bounces = 1, .spacing = 0.002f});
    second.restore(first.stored());
    EXPECT_TRUE(at::equal(first.bounce(seen.raster, seen.surface),
                          second.bounce(seen.raster, seen.surface)));
}

TEST(IndirectLight, GradientsOfShadingAreTheDifferences) {
    const Geometry geometry = floor_and_wall(2);
    const SeenFloor seen = look_at_floor(geometry);
    Surface surface = seen.surface;
    constexpr std::int64_t count = 5;
    for (at::Tensor* rows :
         {&surface.pixel, &surface.position, &surface.normal, &surface.tangent, &surface.uv,
          &surface.color, &surface.view, &surface.material, &surface.primitive})
        *rows = rows->narrow(0, 0, count).contiguous();
    const EnvironmentLight light = prefilter(at::rand({6, 16, 16, 3}));
    const at::Tensor bounce = at::rand({count, 3});
    const IndirectLight::Reflection reflection{at::rand({count, 3}), at::rand({count, 1})};
    // The values are rows of base colour, followed by rows of occlusion, roughness and metallic.
    check_gradient(
        [&](const at::Tensor& values) {
            MaterialSample material;
            material.base_color = values.narrow(0, 0, count);
            material.orm = values.narrow(0, count, count);
            return shade_indirect(surface, material, light, bounce, reflection);
        },
        0.2f + 0.6f * at::rand({2 * count, 3}), 1e-3f, 0.02);
}

}  // namespace
}  // namespace item3d
