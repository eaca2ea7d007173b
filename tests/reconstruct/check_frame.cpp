#include "item3d/reconstruct/dataset/check_frame.h"

#include "item3d/core/error.h"
#include "tests/support/box_scene.h"

#include <glm/gtc/matrix_transform.hpp>

namespace item3d {
namespace {

using testing::photographs_of;
using testing::three_arms;
using testing::transformed;

Mat4 turn(float degrees, Vec3 axis) {
    return glm::rotate(Mat4(1.0f), glm::radians(degrees), axis);
}

std::string refusal_of_frame(const TriangleMesh& mesh, const Dataset& dataset) {
    try {
        check_mesh_frame(mesh, dataset, "arms.obj");
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST(CheckFrame, NothingIsSaidWhereTheMeshFits) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const FrameFit fit = fit_frame(three_arms(), dataset);
    EXPECT_GT(fit.overlap, 0.98);
    EXPECT_TRUE(fit.fits);
    EXPECT_EQ(check_mesh_frame(three_arms(), dataset, "arms.obj"), "");
    // A coarse mesh or inexact poses make the mesh a few percent too large.
    const TriangleMesh larger = transformed(three_arms(), glm::scale(Mat4(1.0f), Vec3(1.06f)));
    EXPECT_LT(fit_frame(larger, dataset).overlap, 0.93);
    EXPECT_EQ(check_mesh_frame(larger, dataset, "arms.obj"), "");
}

TEST(CheckFrame, ThinPartsThatAreOffByAPixelFit) {
    const TriangleMesh rods =
        testing::box_mesh({{Vec3(-0.6f, -0.8f, 0), Vec3(-0.56f, 0.8f, 0.04f)},
                           {Vec3(0.5f, -0.8f, 0.3f), Vec3(0.54f, 0.8f, 0.34f)},
                           {Vec3(-0.6f, 0.4f, 0), Vec3(0.5f, 0.44f, 0.04f)}});
    const Dataset dataset = photographs_of(rods, 12, 128);
    const TriangleMesh moved =
        transformed(rods, glm::translate(Mat4(1.0f), Vec3(0.015f, 0.015f, 0.015f)));
    EXPECT_LT(fit_frame(moved, dataset).overlap, 0.8);
    EXPECT_EQ(check_mesh_frame(moved, dataset, "rods.obj"), "");
}

TEST(CheckFrame, TurnsAreToldInWords) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const std::string single =
        refusal_of_frame(transformed(three_arms(), turn(90, {1, 0, 0})), dataset);
    EXPECT_TRUE(single.starts_with("arms.obj: the mesh's outlines overlap the masks by "))
        << single;
    EXPECT_NE(single.find("; rotated by -90 degrees about x, they overlap by "), std::string::npos)
        << single;
    EXPECT_TRUE(single.ends_with(" %; rotate the mesh or use --place-mesh")) << single;
    // For every rotation of axes to axes, the reported rotation is its inverse.
    for (const Vec3& first : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        for (const Vec3& second : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
            const Mat4 matrix = turn(-90, second) * turn(180, first);
            const FrameFit fit = fit_frame(transformed(three_arms(), matrix), dataset);
            EXPECT_FALSE(fit.fits);
            EXPECT_GT(fit.best.overlap, 0.98);
            EXPECT_EQ(fit.best.scale, 1);
            const Mat3 both = fit.best.turn * Mat3(matrix);
            for (int c = 0; c < 3; ++c)
                EXPECT_LT(glm::length(both[c] - Mat3(1.0f)[c]), 1e-4f) << fit.best.words;
        }
    }
}

TEST(CheckFrame, AnotherUnitAndAnotherPlace) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const std::string inches =
        refusal_of_frame(transformed(three_arms(), glm::scale(Mat4(1.0f), Vec3(39.37f))), dataset);
    EXPECT_NE(inches.find("; scaled by 0.0254 (inches in metres), they overlap by "),
              std::string::npos)
        << inches;
    EXPECT_TRUE(inches.ends_with(" %; place the mesh like this or use --place-mesh")) << inches;
    const Mat4 away = glm::translate(Mat4(1.0f), Vec3(5, -2, 1)) * turn(90, {0, 0, 1});
    const FrameFit fit = fit_frame(transformed(three_arms(), away), dataset);
    EXPECT_GT(fit.best.overlap, 0.9);
    EXPECT_TRUE(fit.best.words.starts_with("rotated by -90 degrees about z")) << fit.best.words;
    EXPECT_NE(fit.best.words.find("then moved by ("), std::string::npos) << fit.best.words;
}

TEST(CheckFrame, UnitsAreToldExactly) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const auto scaled = [](double factor) {
        return glm::scale(Mat4(1.0f), Vec3(static_cast<float>(factor)));
    };
    for (const double factor : {0.001, 100.0, 1 / 0.0254}) {
        const FrameFit fit =
            fit_frame(transformed(three_arms(), scaled(factor) * turn(-90, {1, 0, 0})), dataset);
        EXPECT_FALSE(fit.fits) << factor;
        EXPECT_TRUE(fit.best_fits) << factor;
        EXPECT_NEAR(fit.best.scale * factor, 1, 1e-4);
        EXPECT_EQ(fit.best.move, Vec3(0.0f)) << fit.best.words;
        EXPECT_TRUE(fit.best.words.starts_with("rotated by 90 degrees about x, scaled by "))
            << fit.best.words;
    }
    // The factor is none between two units. The mesh is still scaled about the origin and not
    // moved.
    const FrameFit fit = fit_frame(transformed(three_arms(), scaled(7.3)), dataset);
    EXPECT_GT(fit.best.overlap, 0.95);
    EXPECT_NEAR(fit.best.scale * 7.3, 1, 0.02);
    EXPECT_EQ(fit.best.move, Vec3(0.0f)) << fit.best.words;
}

TEST(CheckFrame, AMeshIsPlacedToAPixel) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const auto left = [&](const Mat4& away) {
        const TriangleMesh mesh = transformed(three_arms(), away);
        const Mat4 back = place_mesh(mesh, dataset, "arms.obj").matrix();
        return (transformed(mesh, back).positions - three_arms().positions)
            .abs()
            .max()
            .item<float>();
    };
    EXPECT_LT(left(glm::scale(Mat4(1.0f), Vec3(100.0f)) * turn(180, {0, 0, 1})), 1e-3f);
    // At the object, a pixel is 0.03 wide.
    EXPECT_LT(left(glm::translate(Mat4(1.0f), Vec3(5, -2, 1)) *
                   glm::scale(Mat4(1.0f), Vec3(0.37f)) * turn(90, {0, 0, 1})),
              0.015f);
    EXPECT_EQ(place_mesh(three_arms(), dataset, "arms.obj").matrix(), Mat4(1.0f));
}

TEST(CheckFrame, TheDatasetsOwnWorldIsTried) {
    Dataset dataset = photographs_of(three_arms(), 12, 96);
    dataset.world_from_dataset = Mat3(turn(40, {1, 0, 0}));
    const std::string text =
        refusal_of_frame(transformed(three_arms(), turn(-40, {1, 0, 0})), dataset);
    EXPECT_NE(
        text.find(
            "rotated by 40.0 degrees about (1.000, 0.000, 0.000), the rotation of the dataset's"),
        std::string::npos)
        << text;
}

TEST(CheckFrame, WhatFitsInNoWayIsRefusedAndWhatIsLargerIsNot) {
    const Dataset dataset = photographs_of(three_arms(), 12, 96);
    const std::string text = refusal_of_frame(
        transformed(three_arms(), turn(45, glm::normalize(Vec3(1, 1, 0)))), dataset);
    EXPECT_NE(text.find("; no axis rotation, unit or position fits"), std::string::npos) << text;
    // The mesh also has a card, whose edges the material cuts out of the masks.
    TriangleMesh with_card = three_arms();
    const TriangleMesh card =
        testing::box_mesh({{Vec3(-0.25f, 0.1f, -0.01f), Vec3(0.7f, 0.9f, 0.01f)}});
    with_card.triangles = at::cat({with_card.triangles, card.triangles + 24});
    with_card.positions = at::cat({with_card.positions, card.positions});
    const std::string warning = check_mesh_frame(with_card, dataset, "arms.obj");
    EXPECT_TRUE(warning.ends_with("it is larger than the object in the masks")) << warning;
}

}  // namespace
}  // namespace item3d
