// Tests of UV maps that an edit keeps, and of the replacement of others.
#include "item3d/field/atlas/atlas.h"

#include "item3d/core/progress.h"
#include "item3d/field/atlas/unwrap.h"
#include "item3d/field/atlas/uv_problem.h"
#include "item3d/field/bake/fill.h"
#include "item3d/field/bake/keep_flat.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

using testing::make_model;
using testing::make_quad;
using testing::make_sphere;

class AtlasTest : public ::testing::Test {
  protected:
    void SetUp() override { set_verbosity(Verbosity::quiet); }
    void TearDown() override { set_verbosity(Verbosity::normal); }
};

std::ptrdiff_t free_texels(const UvRaster& raster) {
    return std::count_if(raster.owners.begin(), raster.owners.end(),
                         [](const UvOwner& owner) { return owner.triangle < 0; });
}

TEST(UvRaster, CoversEachTexelOnceAlongSharedEdges) {
    // The triangles form a fan around an odd centre. Each texel of the square belongs to exactly
    // one of them.
    const Vec2 center(0.4137f, 0.5519f);
    std::vector<Vec2> rim;
    for (int i = 0; i < 8; ++i) {
        const float t = static_cast<float>(i) / 8.0f;
        rim.push_back(Vec2(t, 0.0f));
    }
    for (int i = 0; i < 8; ++i)
        rim.push_back(Vec2(1.0f, static_cast<float>(i) / 8.0f));
    for (int i = 0; i < 8; ++i)
        rim.push_back(Vec2(1.0f - static_cast<float>(i) / 8.0f, 1.0f));
    for (int i = 0; i < 8; ++i)
        rim.push_back(Vec2(0.0f, 1.0f - static_cast<float>(i) / 8.0f));
    std::vector<UvTriangle> triangles;
    for (std::size_t i = 0; i < rim.size(); ++i) {
        UvTriangle triangle{center, rim[i], rim[(i + 1) % rim.size()]};
        if (i % 3 == 0) std::swap(triangle[1], triangle[2]);  // both windings
        triangles.push_back(triangle);
    }
    int overlaps = 0;
    const UvRaster raster =
        rasterize_uv(triangles, 61, 47, {},
                     [&](std::size_t, const UvOwner&, const UvOwner&) { return ++overlaps > 0; });
    EXPECT_EQ(overlaps, 0);
    EXPECT_EQ(free_texels(raster), 0);
    for (int y = 0; y < 47; ++y) {
        for (int x = 0; x < 61; ++x) {
            const UvTriangle& t = triangles[static_cast<std::size_t>(raster.at(x, y))];
            const Vec2 p((static_cast<float>(x) + 0.5f) / 61.0f,
                         (static_cast<float>(y) + 0.5f) / 47.0f);
            const Vec2 b = uv_barycentrics(t, p);
            const Vec2 back = t[0] * b.x + t[1] * b.y + t[2] * (1.0f - b.x - b.y);
            EXPECT_LT(glm::length(back - p), 1e-3f);
        }
    }
}

TEST(UvRaster, SurvivesUselessTriangles) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<UvTriangle> triangles{{Vec2(nan, 0), Vec2(1, 0), Vec2(0, 1)},
                                            {Vec2(0.5f), Vec2(0.5f), Vec2(0.5f)},
                                            {Vec2(1e30f), Vec2(-1e30f, 0), Vec2(0, 1)}};
    const UvRaster raster = rasterize_uv(triangles, 8, 8);
    EXPECT_EQ(free_texels(raster), 64);
}

TEST(UvRaster, ATextureThatRepeatsIsCoveredWholly) {
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat}) {
        for (const float repetitions : {3.0f, 40.0f}) {
            const std::vector<UvTriangle> square{
                {Vec2(0), Vec2(repetitions, 0), Vec2(repetitions)},
                {Vec2(0), Vec2(repetitions), Vec2(0, repetitions)}};
            const UvRaster raster = rasterize_uv(square, 16, 8, {wrap, wrap});
            EXPECT_EQ(free_texels(raster), 0);
            for (int y = 0; y < raster.height; ++y) {
                for (int x = 0; x < raster.width; ++x) {
                    const Vec2 uv = raster.uv_at(x, y);
                    const auto t = static_cast<std::size_t>(raster.at(x, y));
                    const Vec2 b = uv_barycentrics(square[t], uv);
                    const Vec2 back =
                        square[t][0] * b.x + square[t][1] * b.y + square[t][2] * (1.0f - b.x - b.y);
                    EXPECT_LT(glm::length(back - uv), 1e-3f);  // the point is inside
                    EXPECT_NEAR(wrap_coordinate(uv.x, wrap), (static_cast<float>(x) + 0.5f) / 16,
                                1e-4f);
                    EXPECT_NEAR(wrap_coordinate(uv.y, wrap), (static_cast<float>(y) + 0.5f) / 8,
                                1e-4f);
                }
            }
        }
    }
}

TEST(UvRaster, FacesOfAPaletteClaimTheirTexels) {
    const Vec2 center(2.5f / 8, 0.5f), border(6.0f / 8, 0.5f);
    const std::vector<UvTriangle> palette{
        {center, center, center},
        {center, center, center},
        {border, border + Vec2(0.01f, 0), border + Vec2(0, 0.01f)}};
    UvRaster raster = rasterize_uv(palette, 8, 1, {Wrap::clamp_to_edge, Wrap::clamp_to_edge});
    EXPECT_EQ(free_texels(raster), 8);
    claim_texels(raster, palette);
    EXPECT_EQ(raster.at(2, 0), 0);  // belongs to the first of several triangles
    EXPECT_EQ(raster.at(5, 0), 2);  // needed by linear filtering at the border
    EXPECT_EQ(raster.at(6, 0), 2);
    EXPECT_EQ(free_texels(raster), 5);
}

TEST_F(AtlasTest, KeepsAUvMapThatCanBeUsed) {
    const Model model = make_model(make_sphere());
    EXPECT_EQ(find_uv_problem(model, {0}), "");
    const Atlas atlas = make_atlas(model, FieldSpace(model, {0}), {0});
    EXPECT_TRUE(atlas.sets.at(0).is_own());
    EXPECT_TRUE(atlas.primitives.empty());
    EXPECT_EQ(atlas.sets.at(0).triangles.size(), model.triangle_count());
}

TEST_F(AtlasTest, NamesTheProblemOfOneThatCannot) {
    Model model = make_model(make_quad());
    model.primitives[0].uvs.clear();
    EXPECT_NE(find_uv_problem(model, {0}).find("no UV map"), std::string::npos);

    model = make_model(make_quad(Vec2(0.0f), Vec2(2.0f, 1.0f)));
    EXPECT_NE(find_uv_problem(model, {0}).find("leaves the unit square"), std::string::npos);
    model.primitives[0].uvs[2].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(find_uv_problem(model, {0}).find("leaves the unit square"), std::string::npos);

    model = make_model(make_quad(Vec2(0.3f), Vec2(0.3f)));
    EXPECT_NE(find_uv_problem(model, {0}).find("no texels"), std::string::npos);
}

TEST_F(AtlasTest, KeepsAMapThatCrossesTheBorderOfARepeatingTexture) {
    // The map is shifted by a third. Its part beyond 1 uses texels that are free on the other side.
    Model model = make_model(make_quad(Vec2(0.33f, 0.0f), Vec2(1.23f, 1.0f)));
    EXPECT_EQ(find_uv_problem(model, {0}), "");
    const Atlas atlas = make_atlas(model, FieldSpace(model, {0}), {0});
    const UvRaster raster = rasterize_uv(atlas.triangles, 100, 100);
    EXPECT_GE(raster.at(10, 50), 0);
    EXPECT_EQ(raster.at(28, 50), -1);
    EXPECT_GE(raster.at(90, 50), 0);
    // u = 0.105 repeats at 1.105, which lies at x = 2 * 0.775 / 0.9 - 1.
    const std::size_t t = static_cast<std::size_t>(raster.at(10, 50));
    const Vec2 b = uv_barycentrics(atlas.triangles[t], raster.uv_at(10, 50));
    const Primitive& quad = model.primitives[0];
    const auto corner = [&](std::size_t c) { return quad.positions[quad.indices[3 * t + c]]; };
    const Vec3 place = corner(0) * b.x + corner(1) * b.y + corner(2) * (1.0f - b.x - b.y);
    EXPECT_NEAR(place.x, 2.0f * 0.775f / 0.9f - 1.0f, 1e-3f);

    model.textures[0].wrap_u = Wrap::clamp_to_edge;
    EXPECT_NE(find_uv_problem(model, {0}).find("leaves the unit square"), std::string::npos);
}

TEST_F(AtlasTest, SeesOverlapsOfTwoPrimitivesAndOfMirroredHalves) {
    Model model = make_model(make_quad());
    model.primitives.push_back(make_quad(Vec2(0.5f), Vec2(1.0f), Vec3(3.0f, 0.0f, 0.0f)));
    EXPECT_NE(find_uv_problem(model, {0, 1}).find("overlaps"), std::string::npos);
    EXPECT_EQ(find_uv_problem(model, {0}), "");

    // The right half shows the same texels as the left half, mirrored.
    model = make_model(make_quad());
    Primitive& quad = model.primitives[0];
    quad.positions.push_back(Vec3(3.0f, -1.0f, 0.0f));
    quad.positions.push_back(Vec3(3.0f, 1.0f, 0.0f));
    quad.normals.resize(6, Vec3(0.0f, 0.0f, 1.0f));
    quad.uvs.push_back(quad.uvs[0]);
    quad.uvs.push_back(quad.uvs[2]);
    quad.indices.insert(quad.indices.end(), {1, 4, 5, 1, 5, 3});
    EXPECT_NE(find_uv_problem(model, {0}).find("overlaps"), std::string::npos);
}

TEST_F(AtlasTest, AllowsBothSidesOfALeafToShareTexels) {
    Model model = make_model(make_quad());
    Primitive& quad = model.primitives[0];
    quad.indices.insert(quad.indices.end(), {0, 3, 1, 0, 2, 3});
    EXPECT_EQ(find_uv_problem(model, {0}), "");
}

TEST_F(AtlasTest, NewUvMapsAreValidAndShareOneAtlas) {
    Model model = make_model(make_sphere());
    model.primitives.push_back(make_quad(Vec2(0.0f), Vec2(1.0f), Vec3(3.0f, 0.0f, 0.0f)));
    for (Primitive& primitive : model.primitives)
        primitive.uvs.clear();
    const Atlas atlas = make_atlas(model, FieldSpace(model, {0}), {0}, 256);
    ASSERT_FALSE(atlas.sets.at(0).is_own());
    ASSERT_EQ(atlas.primitives.size(), 2u);
    Model remade = model;
    for (const auto& [index, edit] : atlas.primitives) {
        Primitive& primitive = remade.primitives[static_cast<std::size_t>(index)];
        const Primitive& before = model.primitives[static_cast<std::size_t>(index)];
        primitive = apply(edit, before);
        ASSERT_EQ(primitive.indices.size(), before.indices.size());
        for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
            // Triangles keep their order and corners.
            EXPECT_EQ(edit.source_vertices[primitive.indices[i]], before.indices[i]);
        }
    }
    EXPECT_EQ(find_uv_problem(remade, {0, 1}), "");
    const UvRaster raster = rasterize_uv(atlas.triangles, 256, 256);
    const auto unused = free_texels(raster);
    EXPECT_LT(unused, 256 * 256 * 2 / 3);
}

TEST_F(AtlasTest, UnwrapsTinyAndFarAwayModels) {
    for (const float scale : {1e-6f, 1.0f}) {
        Model model = make_model(make_quad());
        Primitive& quad = model.primitives[0];
        quad.uvs.clear();
        const Vec3 offset = scale == 1.0f ? Vec3(5e6f, -3e6f, 1e6f) : Vec3(0.0f);
        for (Vec3& p : quad.positions)
            p = p * scale * 4.0f + offset;
        quad = apply(unwrap({&quad}, 256)[0], quad);
        EXPECT_EQ(find_uv_problem(model, {0}), "") << scale;
    }
}

TEST_F(AtlasTest, InstancesAreUnwrappedOnceAndLieInTheFirstOnesPlace) {
    Model model = make_model(make_sphere());
    model.primitives[0].uvs.clear();
    model.primitives[0].source_mesh = model.primitives[0].source_primitive = 0;
    Primitive copy = model.primitives[0];
    for (Vec3& p : copy.positions)
        p = Vec3(-2.0f * p.x, 2.0f * p.z, 2.0f * p.y) + Vec3(5.0f, 1.0f, 0.0f);
    model.primitives.push_back(copy);
    const FieldSpace space(model, {0});
    EXPECT_EQ(space.first_instance()[1], 0);
    EXPECT_LT(space.bounds()[1].x, 1.01f);
    const Geometry geometry = Geometry::from_model(model);
    const std::int64_t triangles = static_cast<std::int64_t>(copy.indices.size() / 3);
    const at::Tensor which = at::arange(0, triangles, 7, at::kLong);
    const at::Tensor weights = at::full({which.size(0), 2}, 0.3f);
    const Surface first = surface_at(geometry, which, weights);
    const Surface second = surface_at(geometry, which + triangles, weights);
    EXPECT_GT((first.position - second.position).abs().max().item<float>(), 1.0f);
    EXPECT_LT((space.positions(first) - space.positions(second)).abs().max().item<float>(), 1e-4f);

    const Atlas atlas = make_atlas(model, space, {0}, 128);
    EXPECT_EQ(atlas.sets.at(0).triangles.size(), static_cast<std::size_t>(triangles));
    ASSERT_EQ(atlas.primitives.size(), 2u);
    EXPECT_EQ(atlas.primitives.at(0).uvs, atlas.primitives.at(1).uvs);
}

TEST_F(AtlasTest, SizesFollowTheTextureUnlessOneIsAskedFor) {
    Model model = make_model(make_quad());
    model.textures[0].image = Image(96, 48, 3);
    EXPECT_EQ(atlas_size(model, 0, 0), std::make_pair(96, 48));
    EXPECT_EQ(atlas_size(model, 0, 512), std::make_pair(512, 256));
    EXPECT_EQ(atlas_size(model, 0, 100000), std::make_pair(4096, 2048));
    EXPECT_EQ(atlas_size(model, 0, 0, true), std::make_pair(1024, 1024));
    EXPECT_EQ(atlas_size(model, 0, 512, true), std::make_pair(512, 512));
    model.materials[0].base_color_texture = -1;
    EXPECT_EQ(atlas_size(model, 0, 0), std::make_pair(1024, 1024));
}

TEST(FillUncovered, ContinuesTheNearestTexels) {
    Image image(9, 5, 2, 0.0f);
    std::vector<std::uint8_t> covered(45, 0);
    for (int y = 0; y < 5; ++y) {
        image.at(1, y, 0) = 0.25f;
        image.at(7, y, 0) = 0.75f;
        image.at(1, y, 1) = image.at(7, y, 1) = 1.0f;
        covered[static_cast<std::size_t>(y * 9 + 1)] =
            covered[static_cast<std::size_t>(y * 9 + 7)] = 1;
    }
    fill_uncovered(image, covered, 1u);
    for (int y = 0; y < 5; ++y) {
        EXPECT_FLOAT_EQ(image.at(0, y, 0), 0.25f);
        EXPECT_FLOAT_EQ(image.at(3, y, 0), 0.25f);
        EXPECT_FLOAT_EQ(image.at(4, y, 0), 0.5f);
        EXPECT_FLOAT_EQ(image.at(8, y, 0), 0.75f);
        EXPECT_FLOAT_EQ(image.at(4, y, 1), 0.0f);  // channel 1 was not requested
    }
}

TEST(FillInvisible, TakesTheColorAndLeavesTheAlphaOfWhatIsCutOut) {
    Image image(4, 1, 4, 0.9f);
    const std::vector<std::uint8_t> covered{1, 1, 1, 0};
    image.at(0, 0, 0) = 0.25f;
    image.at(0, 0, 3) = 1.0f;
    image.at(1, 0, 3) = image.at(2, 0, 3) = 0.0f;
    fill_invisible(image, covered, 7u, 1);
    EXPECT_FLOAT_EQ(image.at(0, 0, 0), 0.25f);
    EXPECT_FLOAT_EQ(image.at(1, 0, 0), 0.25f);  // next to visible texels
    EXPECT_FLOAT_EQ(image.at(2, 0, 0), 0.25f);  // farther away: the mean
    EXPECT_FLOAT_EQ(image.at(3, 0, 0), 0.25f);
    EXPECT_FLOAT_EQ(image.at(1, 0, 3), 0.0f);
    EXPECT_FLOAT_EQ(image.at(3, 0, 3), 0.9f);
    fill_invisible(image, covered, 15u, 1);
    EXPECT_FLOAT_EQ(image.at(2, 0, 3), 0.0f);
    EXPECT_FLOAT_EQ(image.at(3, 0, 3), 0.0f);
    image.at(1, 0, 0) = 0.5f;
    fill_invisible(image, covered, 8u, 1);
    EXPECT_FLOAT_EQ(image.at(1, 0, 0), 0.5f);  // unchanged: no colour channel was requested
}

TEST(KeepFlat, TexelsOfOneColorBecomeOneColor) {
    const int edge = 16;
    Image source(edge, edge, 3), image(edge, edge, 3);
    for (int y = 0; y < edge; ++y) {
        for (int x = 0; x < edge; ++x) {
            const bool left = x < edge / 2;
            source.at(x, y, 0) = left ? 0.2f : 0.8f;
            image.at(x, y, 0) = (left ? 0.5f : 0.6f) + 0.001f * static_cast<float>(y);
            image.at(x, y, 1) = left ? 0.1f : 0.05f * static_cast<float>(y);
        }
    }
    std::vector<std::uint8_t> covered(edge * edge, 1);
    covered[0] = 0;
    const Image before = image;
    keep_flat(image, source, covered, 3u, 10.0f / 255);
    EXPECT_EQ(image.at(0, 0, 0), before.at(0, 0, 0));
    EXPECT_EQ(image.at(1, 0, 0), image.at(7, 15, 0));
    EXPECT_NEAR(image.at(1, 0, 0), 0.5075f, 1e-3f);
    EXPECT_NEAR(image.at(8, 3, 0), 0.6075f, 1e-3f);
    EXPECT_EQ(image.at(8, 3, 1), before.at(8, 3, 1));  // the edit gave different values

    // The source has more colours than any painting.
    Image many(64, 64, 3), changed(64, 64, 3);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            many.at(x, y, 0) = static_cast<float>(x) / 255;
            many.at(x, y, 1) = static_cast<float>(y) / 255;
            changed.at(x, y, 0) = 0.001f * static_cast<float>(x % 5);
        }
    }
    const Image as_it_was = changed;
    keep_flat(changed, many, std::vector<std::uint8_t>(64 * 64, 1), 7u, 10.0f / 255);
    EXPECT_EQ(changed.pixels, as_it_was.pixels);
}

}  // namespace
}  // namespace item3d
