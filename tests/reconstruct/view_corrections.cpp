#include "item3d/reconstruct/surface/view_corrections.h"

#include "item3d/reconstruct/shape/align_poses.h"
#include "item3d/reconstruct/shape/find_shape.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "tests/support/box_scene.h"

#include <algorithm>

namespace item3d {
namespace {

using testing::photographs_of;
using testing::three_arms;

/// Returns corrections of `dataset` after an optimiser changed each view slightly differently.
ViewCorrections moved_corrections(const Dataset& dataset) {
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius,
                                {.poses = PoseRefinement::refine});
    Adam adam;
    corrections.add_groups(adam);
    corrections.set_rates(adam, 20);
    for (std::size_t i = 0; i < dataset.train.size(); ++i) {
        const RigidMotion motion = corrections.motion(i);
        const float way = i % 2 == 0 ? 1.0f : -1.0f;
        (way * (motion.translation.sum() + (motion.rotation * at::arange(9).reshape({3, 3})).sum()))
            .backward();
        adam.step();
        adam.zero_grad();
    }
    return corrections;
}

TEST(ViewCorrections, AMovedObjectLooksAsFromAMovedCamera) {
    const Dataset dataset = photographs_of(three_arms(), 6, 16);
    const ViewCorrections corrections = moved_corrections(dataset);
    EXPECT_GT(corrections.largest_turn(), 0.3);
    EXPECT_GT(corrections.largest_shift(), 0.01);
    const Geometry geometry = untextured_geometry(three_arms().positions, three_arms().triangles);
    for (std::size_t i = 0; i < dataset.train.size(); ++i) {
        const at::NoGradGuard no_gradient;
        const RigidMotion motion = corrections.motion(i);
        const Camera& camera = dataset.train[i].camera;
        const auto clip = [](const Geometry& what, const Camera& from) {
            return rasterize(what, {from}, 16, 16).positions_clip;
        };
        const at::Tensor a = clip(motion.moved(geometry), camera);
        const at::Tensor b = clip(geometry, motion.seen_from(camera));
        EXPECT_LT((a - b).abs().max().item<float>(), 1e-4f);

        Surface surface;
        const Geometry moved = motion.moved(geometry);
        surface.position = moved.positions;
        surface.normal = surface.view = moved.normals;
        motion.move_back(surface);
        EXPECT_LT((surface.position - geometry.positions).abs().max().item<float>(), 1e-5f);
        EXPECT_LT((surface.normal - geometry.normals).abs().max().item<float>(), 1e-5f);
    }
}

TEST(ViewCorrections, AreKeptAndComeBack) {
    const Dataset dataset = photographs_of(three_arms(), 6, 16);
    const ViewCorrections first = moved_corrections(dataset);
    ViewCorrections second(dataset.train, dataset.centre, dataset.radius,
                           {.poses = PoseRefinement::refine});
    second.load_state(CheckpointReader("checkpoint", first.state()));
    for (std::size_t i = 0; i < dataset.train.size(); ++i)
        EXPECT_TRUE(at::equal(first.motion(i).rotation, second.motion(i).rotation));
}

TEST(ViewCorrections, GainsFollowADriftAndNotOneView) {
    const Dataset dataset = photographs_of(three_arms(), 6, 24);
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, {});
    const auto show = [&](std::size_t view, float gain) {
        at::Tensor photograph = at::full({1, 16, 16, 4}, 0.2f);
        photograph.select(3, 3).fill_(1.0f);
        at::Tensor brighter = photograph.clone();
        brighter.narrow(3, 0, 3).mul_(gain);
        for (int k = 0; k < 12; ++k)
            corrections.update_gain(view, photograph, brighter);
    };
    show(0, 1.4f);
    EXPECT_FLOAT_EQ(corrections.gains().max().item<float>(), 1.0f);
    const float gains[6] = {1.2f, 0.8f, 1.1f, 0.9f, 1.0f, 1.15f};
    for (std::size_t i = 0; i < 6; ++i)
        show(i, gains[i]);
    // The median of these gains is 1, so they are found as they are.
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(corrections.gain(i)[1].item<float>(), gains[i], 0.01f);
}

TEST(ViewCorrections, WhatAPartOfAImageLacksIsNoGain) {
    const Dataset dataset = photographs_of(three_arms(), 6, 24);
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, {});
    at::Tensor drawn = at::full({1, 16, 16, 4}, 0.2f);
    drawn.select(3, 3).fill_(1.0f);
    for (std::size_t i = 0; i < 6; ++i) {
        at::Tensor photograph = drawn.clone();
        const float brighter = i % 2 == 0 ? 1.3f : 1.0f;
        // The quotient differs between rows, so that no single quotient holds for the whole image.
        for (std::int64_t row = 0; row < 16; ++row)
            photograph[0][row].narrow(1, 0, 3).mul_(brighter *
                                                    (0.6f + 0.05f * static_cast<float>(row)));
        for (int k = 0; k < 12; ++k)
            corrections.update_gain(i, drawn, photograph);
    }
    const at::Tensor apart = corrections.gains().log().abs();
    EXPECT_LT(apart.max().item<float>(), 0.5f * std::log(1.3f));
}

TEST(ViewCorrections, ABlurredImageIsFound) {
    Dataset dataset = photographs_of(three_arms(), 40, 128);
    for (std::size_t v = 0; v < dataset.train.size(); ++v) {
        Image& image = dataset.train[v].image;
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x)
                for (int c = 0; c < 3; ++c)
                    image.at(x, y, c) *= v == 5 ? 0.75f : ((x / 2 + y / 2) % 2 == 0 ? 1.0f : 0.5f);
    }
    const ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, {});
    EXPECT_EQ(corrections.blurred(), std::vector<std::size_t>{5});
    EXPECT_LT(corrections.weight(5), 0.2);
}

TEST(AlignPoses, OutlinesOfPosesThatAreOffAgreeAfterwards) {
    Dataset dataset = photographs_of(three_arms(), 9, 48);
    const Dataset exact = dataset;
    Random random(3, RandomStream::chamfer);
    for (Photograph& view : dataset.train) {
        const Vec3 shift = 0.08f * Vec3(random.normal(), random.normal(), random.normal());
        view.camera.camera_to_world[3] += Vec4(shift, 0);
    }
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, {});
    const VisualHull hull(dataset.train);
    const double before = hull.disagreement(dataset.train, dataset.centre, dataset.radius);
    const double after = align_to_hull(dataset, "arms", corrections);
    EXPECT_GT(before, 0.1);
    EXPECT_LT(after, 0.4 * before);
    EXPECT_TRUE(corrections.refines_poses());

    ViewCorrections of_exact(exact.train, exact.centre, exact.radius, {});
    EXPECT_LT(align_to_hull(exact, "arms", of_exact), 0.02);
    EXPECT_FALSE(of_exact.refines_poses());
}

}  // namespace
}  // namespace item3d
