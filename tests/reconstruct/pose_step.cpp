#include "item3d/reconstruct/surface/pose_step.h"

#include "item3d/reconstruct/shape/find_shape.h"
#include "item3d/render/antialias.h"
#include "item3d/render/scatter.h"
#include "item3d/scene/camera.h"
#include "tests/support/box_scene.h"

namespace item3d {
namespace {

/// Draws boxes whose colours vary in space, after moving them by `motion`.
DrawnView draw_boxes(const Camera& camera, const RigidMotion& motion) {
    constexpr int size = 96;
    const TriangleMesh mesh = testing::three_arms();
    const Geometry still = untextured_geometry(mesh.positions, mesh.triangles);
    const Geometry seen = motion.moved(still);
    const Raster raster = rasterize(seen, {camera}, size, size);
    Surface surface = interpolate_surface(seen, raster, {camera});
    const at::Tensor position = surface.position;
    motion.move_back(surface);
    const at::Tensor color = 0.4f + 0.3f * at::sin(9.0f * surface.position);
    const at::Tensor values = at::cat({color, at::ones_like(color.narrow(1, 0, 1))}, 1);
    return {camera, antialias(scatter(values, surface, raster, at::zeros({4})), raster, seen),
            surface.pixel, position};
}

TEST(PoseStep, BringsAMovedCameraBack) {
    const at::Tensor centre = at::tensor({0.1f, 0.0f, 0.0f});
    constexpr float radius = 1.3f;
    for (Camera camera : testing::ring_of_cameras(3)) {
        fit_depth_range(camera, {Vec3(-1.5f), Vec3(1.5f)});
        const at::Tensor off = at::tensor({0.010f, -0.008f, 0.006f, 0.007f, -0.009f, 0.004f});
        const RigidMotion truth =
            rigid_motion({off.narrow(0, 0, 3), off.narrow(0, 3, 3)}, centre, radius);
        const at::Tensor photograph = draw_boxes(camera, truth).image;
        at::Tensor found = at::zeros({6});
        const auto difference = [&] {
            const RigidMotion motion =
                rigid_motion({found.narrow(0, 0, 3), found.narrow(0, 3, 3)}, centre, radius);
            return (draw_boxes(camera, motion).image - photograph).abs().mean().item<float>();
        };
        const float before = difference();
        for (int step = 0; step < 8; ++step) {
            const RigidMotion motion =
                rigid_motion({found.narrow(0, 0, 3), found.narrow(0, 3, 3)}, centre, radius);
            const SmallMotion change =
                pose_step(draw_boxes(camera, motion), photograph, centre, radius);
            found += at::cat({change.rotation, change.translation});
        }
        EXPECT_LT(difference(), 0.1f * before) << camera.name;
        EXPECT_LT((found - off).norm().item<float>(), 0.15f * off.norm().item<float>())
            << camera.name;
    }
}

TEST(PoseStep, StaysWhereNothingIsDrawn) {
    const Camera camera = testing::ring_of_cameras(3)[0];
    const SmallMotion step =
        pose_step({camera, at::zeros({1, 32, 32, 4}), at::zeros({0}, at::kLong), at::zeros({0, 3})},
                  at::ones({1, 32, 32, 4}), at::zeros({3}), 1);
    EXPECT_EQ(step.rotation.abs().max().item<float>(), 0);
    EXPECT_EQ(step.translation.abs().max().item<float>(), 0);
}

}  // namespace
}  // namespace item3d
