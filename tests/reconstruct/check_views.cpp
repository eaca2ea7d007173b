#include "item3d/reconstruct/dataset/check_views.h"

#include "item3d/core/error.h"
#include "tests/support/box_scene.h"

#include <functional>

namespace item3d {
namespace {

using testing::photographs_of;
using testing::three_arms;

std::string refusal_of_views(const Dataset& dataset) {
    try {
        check_views(dataset, "arms");
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

Image left_to_right(const Image& image) {
    Image result = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c)
                result.at(x, y, c) = image.at(image.width - 1 - x, y, c);
    return result;
}

/// Sets each pixel of the object to a colour that `color` returns for the pixel's number.
void paint(Dataset& dataset, const std::function<Vec4(int)>& color) {
    for (Photograph& view : dataset.train) {
        int count = 0;
        for (std::size_t i = 0; i < view.image.pixels.size(); i += 4) {
            if (view.image.pixels[i + 3] < 0.5f) continue;
            const Vec4 value = color(count++);
            for (int c = 0; c < 4; ++c)
                view.image.pixels[i + static_cast<std::size_t>(c)] = value[c];
        }
    }
}

TEST(CheckViews, NothingIsSaidOfGoodOnes) {
    for (const int count : {3, 5, 14}) {
        const ViewProblems problems = check_views(photographs_of(three_arms(), count, 96), "arms");
        EXPECT_TRUE(problems.warnings.empty());
        EXPECT_TRUE(problems.contradicting.empty());
    }
    // The rods are thinner than the lattice's cells.
    const TriangleMesh rods =
        testing::box_mesh({{Vec3(-0.6f, -0.8f, 0), Vec3(-0.58f, 0.8f, 0.02f)},
                           {Vec3(0.5f, -0.8f, 0.3f), Vec3(0.52f, 0.8f, 0.32f)},
                           {Vec3(-0.6f, 0.4f, 0), Vec3(0.5f, 0.42f, 0.02f)}});
    for (const int size : {48, 160})
        EXPECT_TRUE(check_views(photographs_of(rods, 14, size), "rods").warnings.empty());
}

TEST(CheckViews, OfACutOffObjectNothingIsSaid) {
    Dataset dataset = photographs_of(three_arms(), 24, 96);
    // Some images are cropped to their middle, as by the same camera with a longer lens.
    for (std::size_t i = 0; i < dataset.train.size(); i += 3) {
        Photograph& view = dataset.train[i];
        Image middle(40, 40, 4);
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 40; ++x)
                for (int c = 0; c < 4; ++c)
                    middle.at(x, y, c) = view.image.at(x + 28, y + 28, c);
        view.image = middle;
        view.camera.field_of_view_x =
            2 * std::atan(40.0f / 96 * std::tan(0.5f * view.camera.field_of_view_x));
    }
    EXPECT_TRUE(check_views(dataset, "arms").warnings.empty());
}

TEST(CheckViews, ViewsThatContradictAreNamed) {
    const Dataset good = photographs_of(three_arms(), 24, 96);
    Dataset dataset = good;
    dataset.train[7].image = good.train[14].image;
    ViewProblems problems = check_views(dataset, "arms");
    EXPECT_EQ(problems.contradicting, std::vector<std::size_t>{7});
    ASSERT_EQ(problems.warnings.size(), 1u);
    EXPECT_EQ(problems.warnings[0],
              "1 of 24 images contradicts the others and is left out: 'view_7'; its pose or mask "
              "is wrong");

    for (const std::size_t i : {2, 11, 20})
        dataset.train[i].image = left_to_right(good.train[(i + 5) % 24].image);
    problems = check_views(dataset, "arms");
    std::sort(problems.contradicting.begin(), problems.contradicting.end());
    EXPECT_EQ(problems.contradicting, (std::vector<std::size_t>{2, 7, 11, 20}));
    ASSERT_EQ(problems.warnings.size(), 1u);
    EXPECT_TRUE(problems.warnings[0].starts_with(
        "4 of 24 images contradict the others and are left out: "));
    EXPECT_NE(problems.warnings[0].find(", ...; the object moved"), std::string::npos);

    // With only three images, none can be identified as wrong.
    dataset = photographs_of(three_arms(), 3, 96);
    dataset.train[1].image = left_to_right(good.train[3].image);
    problems = check_views(dataset, "arms");
    EXPECT_TRUE(problems.contradicting.empty());
}

TEST(CheckViews, WhatWasDoneToAllViewsIsFound) {
    const Dataset good = photographs_of(three_arms(), 14, 64);
    Dataset dataset = good;
    for (Photograph& view : dataset.train)
        view.image = left_to_right(view.image);
    const std::string mirrored = refusal_of_views(dataset);
    EXPECT_TRUE(mirrored.starts_with("arms: the images look mirrored: ")) << mirrored;
    EXPECT_TRUE(mirrored.ends_with("; flip all images left to right")) << mirrored;

    dataset = good;
    for (Photograph& view : dataset.train)
        for (int c : {1, 2})
            view.camera.camera_to_world[c] *= -1.0f;
    EXPECT_TRUE(refusal_of_views(dataset).starts_with("arms: the cameras look along +z: "));

    dataset = good;
    dataset.world_from_dataset = Mat3(testing::y_up_to_z_up());
    const Mat4 world(dataset.world_from_dataset);
    for (Photograph& view : dataset.train)
        view.camera.camera_to_world =
            world * glm::inverse(glm::transpose(world) * view.camera.camera_to_world);
    EXPECT_TRUE(refusal_of_views(dataset).starts_with("arms: the poses look inverted: "));
}

TEST(CheckViews, AnObjectThatMovesIsSaid) {
    Dataset dataset = photographs_of(three_arms(), 14, 64);
    for (std::size_t i = 0; i < dataset.train.size(); ++i)
        dataset.train[i].camera.camera_to_world[3].x += 0.05f * static_cast<float>(i);
    const ViewProblems problems = check_views(dataset, "arms");
    EXPECT_TRUE(problems.contradicting.empty());
    ASSERT_EQ(problems.warnings.size(), 1u);
    EXPECT_NE(problems.warnings[0].find("the object moved, or poses"), std::string::npos);
}

TEST(CheckViews, ImagesThatAreTooBrightOrTooDark) {
    Dataset dataset = photographs_of(three_arms(), 8, 64);
    const auto warnings_of = [&](const std::function<Vec4(int)>& color) {
        paint(dataset, color);
        return check_views(dataset, "arms").warnings;
    };
    paint(dataset, [](int) { return Vec4(1, 1, 0.7f, 1); });
    EXPECT_TRUE(
        refusal_of_views(dataset).starts_with("arms: 8 of 8 images are overexposed: 100 %"));
    EXPECT_TRUE(refusal_of_views(dataset).ends_with("; use a shorter exposure"));
    auto warnings =
        warnings_of([](int i) { return Vec4(i % 3 == 0 ? 1.0f : 0.5f, 0.5f, 0.5f, 1); });
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(warnings[0].starts_with("33 % of the object's pixels are clipped"));
    // Highlights cause no warning, nor do images with values above 1.
    EXPECT_TRUE(
        warnings_of([](int i) { return Vec4(Vec3(i % 10 == 0 ? 1.0f : 0.5f), 1); }).empty());
    EXPECT_TRUE(
        warnings_of([](int i) { return Vec4(Vec3(i % 10 == 0 ? 3.0f : 1.0f), 1); }).empty());

    paint(dataset, [](int) { return Vec4(0.001f, 0.001f, 0.001f, 1); });
    EXPECT_TRUE(refusal_of_views(dataset).starts_with("arms: 8 of 8 images show a black object"));
    warnings = warnings_of([](int i) { return Vec4(Vec3(i % 4 == 0 ? 0.1f : 0.0f), 1); });
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(warnings[0].starts_with("75 % of the object's pixels are black"));
    EXPECT_TRUE(
        warnings_of([](int i) { return Vec4(Vec3(i % 2 == 0 ? 0.02f : 0.0f), 1); }).empty());
}

TEST(CheckViews, MasksOfWhatIsTransparent) {
    Dataset dataset = photographs_of(three_arms(), 8, 96);
    for (Photograph& view : dataset.train)
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 96; ++x)
                for (int c = 0; c < 4; ++c)
                    view.image.at(x, y, c) *= 0.6f;
    const ViewProblems problems = check_views(dataset, "arms");
    ASSERT_EQ(problems.warnings.size(), 1u);
    EXPECT_NE(problems.warnings[0].find("is semi-transparent"), std::string::npos);
    EXPECT_TRUE(problems.contradicting.empty());

    // Outlines that are two partly covered pixels wide are not taken for glass.
    dataset = photographs_of(three_arms(), 8, 96);
    for (Photograph& view : dataset.train) {
        const Image before = view.image;
        for (int y = 1; y < 95; ++y)
            for (int x = 1; x < 95; ++x)
                for (int c = 0; c < 4; ++c)
                    view.image.at(x, y, c) =
                        0.2f *
                        (before.at(x, y, c) + before.at(x - 1, y, c) + before.at(x, y - 1, c) +
                         before.at(x + 1, y, c) + before.at(x, y + 1, c));
    }
    EXPECT_TRUE(check_views(dataset, "arms").warnings.empty());
}

}  // namespace
}  // namespace item3d
