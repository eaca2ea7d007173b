// Tests of MikkTSpace against its reference implementation and against values found by hand.
#include "item3d/render/tangents.h"

#include "item3d/core/files.h"
#include "tests/support/render.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>

namespace item3d {
namespace {

Primitive square(const std::vector<Vec2>& uvs) {
    Primitive primitive;
    primitive.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    primitive.normals.assign(4, Vec3(0, 0, 1));
    primitive.uvs = uvs;
    primitive.indices = {0, 1, 2, 0, 2, 3};
    return primitive;
}

void expect_tangent(const Vec4& found, const Vec4& wanted, float tolerance = 1e-6f) {
    for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(found[c], wanted[c], tolerance) << "component " << c;
}

void expect_frames(const Primitive& primitive) {
    ASSERT_EQ(primitive.tangents.size(), primitive.positions.size());
    for (const std::uint32_t i : primitive.indices) {
        const Vec4 tangent = primitive.tangents[i];
        ASSERT_NEAR(glm::length(Vec3(tangent)), 1.0f, 1e-5f);
        ASSERT_NEAR(glm::dot(Vec3(tangent), primitive.normals[i]), 0.0f, 1e-5f);
        ASSERT_EQ(std::abs(tangent.w), 1.0f);
    }
}

TEST(Tangents, AreThoseOfTheReferenceImplementation) {
    const auto json = nlohmann::json::parse(
        read_text(std::filesystem::path(ITEM3D_TEST_DATA) / "render" / "tangents.json"));
    const auto numbers = [&](const char* key) { return json[key].get<std::vector<float>>(); };
    const std::vector<float> positions = numbers("positions"), normals = numbers("normals"),
                             uvs = numbers("uvs"), wanted = numbers("tangents");
    Primitive primitive;
    for (std::size_t i = 0; 3 * i < positions.size(); ++i) {
        primitive.positions.push_back(
            {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
        primitive.normals.push_back({normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]});
        primitive.uvs.push_back({uvs[2 * i], uvs[2 * i + 1]});
    }
    primitive.indices = json["indices"].get<std::vector<std::uint32_t>>();
    const std::vector<Vec4> tangents = corner_tangents(primitive);
    ASSERT_EQ(4 * tangents.size(), wanted.size());
    int without_direction = 0;
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        SCOPED_TRACE("corner " + std::to_string(i));
        // Where the tangent is undetermined, the reference returns (1, 0, 0), whatever the normal.
        if (std::abs(wanted[4 * i] * primitive.normals[primitive.indices[i]].x) > 0.2f &&
            wanted[4 * i] == 1.0f) {
            ++without_direction;
            continue;
        }
        expect_tangent(tangents[i],
                       {wanted[4 * i], wanted[4 * i + 1], wanted[4 * i + 2], wanted[4 * i + 3]},
                       2e-5f);
    }
    EXPECT_EQ(without_direction, 1);
    add_tangents(primitive);
    expect_frames(primitive);
    for (std::size_t i = 0; i < tangents.size(); ++i)
        EXPECT_EQ(primitive.tangents[primitive.indices[i]], tangents[i]);
}

TEST(Tangents, FollowTheCoordinates) {
    Primitive upright = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
    add_tangents(upright);
    EXPECT_EQ(upright.positions.size(), 4u);
    for (const Vec4& tangent : upright.tangents)
        expect_tangent(tangent, {1, 0, 0, 1});
    Primitive turned = square({{0, 0}, {0, 1}, {1, 1}, {1, 0}});
    add_tangents(turned);
    for (const Vec4& tangent : turned.tangents)
        expect_tangent(tangent, {0, 1, 0, 1});
}

// The two squares share an edge and show the same half of an image. u decreases on one and
// increases on the other, so no single frame at the edge fits both.
TEST(Tangents, VerticesOfMirroredSeamsAreSplit) {
    Primitive primitive;
    primitive.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    primitive.normals.assign(6, Vec3(0, 0, 1));
    primitive.uvs = {{1, 1}, {0, 1}, {1, 1}, {1, 0}, {0, 0}, {1, 0}};
    primitive.colors.assign(6, Vec4(0.5f));
    primitive.colors[4] = Vec4(0.25f);
    primitive.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    const Primitive before = primitive;
    add_tangents(primitive);
    ASSERT_EQ(primitive.positions.size(), 8u);
    expect_frames(primitive);
    for (std::size_t i = 0; i < 12; ++i) {
        const std::uint32_t now = primitive.indices[i], then = before.indices[i];
        EXPECT_EQ(primitive.positions[now], before.positions[then]);
        EXPECT_EQ(primitive.normals[now], before.normals[then]);
        EXPECT_EQ(primitive.uvs[now], before.uvs[then]);
        EXPECT_EQ(primitive.colors[now], before.colors[then]);
        expect_tangent(primitive.tangents[now], i < 6 ? Vec4(-1, 0, 0, -1) : Vec4(1, 0, 0, 1));
    }
    // The renderer gets the split vertices, and still finds that the triangles share the middle
    // edge.
    Model model;
    model.materials.emplace_back();
    model.primitives = {before};
    const Geometry geometry = Geometry::from_model(model);
    EXPECT_EQ(geometry.positions.size(0), 8);
    EXPECT_EQ(geometry.tangents.size(0), 8);
    EXPECT_EQ(geometry.colors.size(0), 8);
    EXPECT_EQ((geometry.neighbours >= 0).sum().item<std::int64_t>(), 6);
}

TEST(Tangents, OfASpherePointEast) {
    Model model = make_unit_sphere(60, 120);
    Primitive& sphere = model.primitives[0];
    const std::size_t count = sphere.positions.size();
    add_tangents(sphere);
    expect_frames(sphere);
    EXPECT_EQ(sphere.positions.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 p = sphere.positions[i];
        if (std::abs(p.y) > 0.99f) continue;  // u has no direction at the poles
        // A tangent on the seam has triangles on one side only, so its error is half a step of
        // longitude.
        const Vec3 east = glm::normalize(Vec3(p.z, 0, -p.x));
        expect_tangent(sphere.tangents[i], Vec4(east, 1.0f), 1.01f * pi / 120);
    }
}

TEST(Tangents, DoNotDependOnTheOrderOfTriangles) {
    Primitive sphere = make_unit_sphere(9, 14).primitives[0];
    for (Vec2& uv : sphere.uvs)
        uv.x = std::abs(uv.x - 0.5f);  // makes a mirrored seam
    const std::size_t triangles = sphere.indices.size() / 3;
    Primitive shuffled = sphere;
    const auto place = [&](std::size_t t) { return (t * 101 + 17) % triangles; };
    ASSERT_EQ(std::gcd(std::size_t{101}, triangles), 1u);
    for (std::size_t t = 0; t < triangles; ++t) {
        // Each triangle gets another index and another first corner.
        for (std::size_t k = 0; k < 3; ++k)
            shuffled.indices[3 * place(t) + k] = sphere.indices[3 * t + (k + t) % 3];
    }
    const std::vector<Vec4> wanted = corner_tangents(sphere), found = corner_tangents(shuffled);
    for (std::size_t t = 0; t < triangles; ++t) {
        // At the poles, triangles without area use any frame of their vertices.
        if (t < 28 && t % 2 == 1) continue;
        for (std::size_t k = 0; k < 3; ++k)
            expect_tangent(found[3 * place(t) + k], wanted[3 * t + (k + t) % 3], 1e-5f);
    }
    add_tangents(sphere);
    add_tangents(shuffled);
    EXPECT_EQ(sphere.positions.size(), shuffled.positions.size());
    EXPECT_GT(sphere.positions.size(), wanted.size() / 6);
}

TEST(Tangents, AreFramesWhateverTheCoordinates) {
    const float huge = 3e38f, tiny = 1e-30f;
    const float infinite = std::numeric_limits<float>::infinity();
    const std::vector<std::vector<Vec2>> cases = {
        {{0, 0}, {0, 0}, {0, 0}, {0, 0}},                  // one point
        {{0, 0}, {1, 1}, {2, 2}, {3, 3}},                  // all on a line
        {{0, 0}, {1, 0}, {1, 1}, {1, 1}},                  // the second triangle has no area
        {{0, 0}, {huge, 0}, {huge, huge}, {-huge, huge}},  // overflows in float
        {{0, 0}, {tiny, 0}, {tiny, tiny}, {0, tiny}},
        {{0, 0}, {infinite, 0}, {NAN, 1}, {0, 1}}};
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(i);
        Primitive primitive = square(cases[i]);
        add_tangents(primitive);
        expect_frames(primitive);
    }
    // Some triangles have no area, and one is perpendicular to its normals.
    Primitive primitive = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
    primitive.indices = {0, 0, 1, 2, 2, 2, 0, 1, 3};
    primitive.normals.assign(4, Vec3(1, 0, 0));
    add_tangents(primitive);
    expect_frames(primitive);
    Primitive empty;
    add_tangents(empty);
    EXPECT_TRUE(empty.tangents.empty());
}

}  // namespace
}  // namespace item3d
