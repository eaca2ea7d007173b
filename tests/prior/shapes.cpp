// Tests of procedural shapes: distances, triangles and views.
#include "item3d/prior/data/shapes/shapes.h"

#include "item3d/lighting/environment.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/materials/makers.h"
#include "item3d/prior/data/shapes/lathe.h"
#include "item3d/prior/data/shapes/polygonize.h"
#include "item3d/prior/data/shapes/shape_models.h"
#include "item3d/prior/data/sky_visibility.h"
#include "item3d/prior/data/views.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace item3d {
namespace {

TEST(PriorShapes, InterpolationStaysBetweenItsPoints) {
    const std::vector<float> x{0, 1, 2, 4}, y{1, 3, 3, 2};
    for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(interpolate_monotone(x, y, x[i]), y[i], 1e-6);
    for (float at = 1; at <= 2; at += .1f)
        EXPECT_NEAR(interpolate_monotone(x, y, at), 3, 1e-6);
    for (float at = 2; at <= 4; at += .1f) {
        EXPECT_LE(interpolate_monotone(x, y, at), 3 + 1e-6);
        EXPECT_GE(interpolate_monotone(x, y, at), 2 - 1e-6);
    }
}

TEST(PriorShapes, SphereBecomesAClosedSurfaceFacingOutwards) {
    const auto ball = [](const Vec3& p) { return sdf::sphere(p, {.1f, 0, -.2f}, .6f); };
    const Polygonized mesh = polygonize(ball, 40);
    EXPECT_NEAR(mesh.scale, .6f, .02f);
    EXPECT_NEAR(glm::length(mesh.center - Vec3(.1f, 0, -.2f)), 0, .02f);
    const Primitive& primitive = mesh.primitive;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double area = 0;
    for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        const std::uint32_t corner[3] = {primitive.indices[i], primitive.indices[i + 1],
                                         primitive.indices[i + 2]};
        for (int k = 0; k < 3; ++k)
            ++edges[{corner[k], corner[(k + 1) % 3]}];
        const Vec3 a = primitive.positions[corner[0]];
        const Vec3 cross =
            glm::cross(primitive.positions[corner[1]] - a, primitive.positions[corner[2]] - a);
        EXPECT_GT(glm::dot(cross, a), 0);
        area += .5 * glm::length(cross);
    }
    // On a closed surface, each directed edge occurs once, and so does its opposite.
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    EXPECT_NEAR(area, 4 * pi, .2);
    for (std::size_t i = 0; i < primitive.positions.size(); ++i)
        EXPECT_GT(glm::dot(primitive.normals[i], glm::normalize(primitive.positions[i])), .99f);
}

TEST(PriorShapes, EveryClassFitsTheGridAndVaries) {
    for (const ShapeClass& shape : shape_classes()) {
        const auto distance_of = [&](int variant) -> SignedDistance {
            return [made = make_shape(shape.name, variant)](const Vec3& p) {
                return made.distance(p);
            };
        };
        const SignedDistance first = distance_of(0), second = distance_of(31);
        const SignedDistance again = distance_of(0);
        Random random(5);
        double difference = 0;
        for (int i = 0; i < 200; ++i) {
            const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
            EXPECT_EQ(first(p), again(p));
            difference += std::abs(first(p) - second(p));
        }
        EXPECT_GT(difference, .01) << shape.name;
        // The shape must not reach the faces of the grid, which would cut it off.
        for (int i = 0; i < 400; ++i) {
            Vec3 p{random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)};
            p[i % 3] = i % 2 ? 1.3f : -1.3f;
            EXPECT_GT(first(p), 0) << shape.name;
        }
        const Polygonized mesh = polygonize(first, 48);
        float farthest = 0;
        for (const Vec3& p : mesh.primitive.positions)
            farthest = std::max(farthest, glm::length(p));
        EXPECT_NEAR(farthest, 1, 1e-4) << shape.name;
    }
}

TEST(PriorShapes, PartsAreFoundWhereTheyAre) {
    const Shape mug = make_shape("mug", 0);
    ASSERT_EQ(mug.parts.size(), 2u);
    EXPECT_EQ(mug.parts[1].noun, "handle");
    EXPECT_EQ(mug.part_at({.9f, 0, 0}), 1);
    EXPECT_EQ(mug.part_at({-.5f, 0, 0}), 0);
    int both = 0;
    for (const ShapeView& view : make_views("mug", 0, 6, 4, 64))
        both += std::set<int>(view.part.begin(), view.part.end()).size() == 2;
    EXPECT_GE(both, 2);  // the handle is hidden from some directions
}

TEST(PriorShapes, SkyIsDarkBelowATable) {
    Shape table{{{"", [](const Vec3& p) { return sdf::box(p, {0, .2f, 0}, {.9f, .05f, .9f}); }}}};
    Polygonized mesh = polygonize(table.parts[0].distance, 64);
    Model model;
    model.primitives.push_back(mesh.primitive);
    model.materials.emplace_back();
    SkyVisibility sky(Geometry::from_model(model));
    SkyLight above{};
    for (std::size_t i = 0; i < sky_parts; ++i)
        above[i] = std::max(sky_directions()[i].y, 0.0f);
    const Vec3 up(0, 1, 0);
    EXPECT_GT(arriving_share(sky.at({0, .3f, 0}, up), up, above), .95f);
    EXPECT_LT(arriving_share(sky.at({0, -.2f, 0}, up), up, above), .2f);
    // The light's whole energy comes from one texel.
    Image map(64, 32, 3);
    map.at(5, 4, 0) = map.at(5, 4, 1) = map.at(5, 4, 2) = 1;
    float total = 0;
    for (const float part : sky_light(map))
        total += part;
    EXPECT_NEAR(total, texel_solid_angle(4, 32), 1e-5);
}

TEST(PriorShapes, ViewsAreFilledAndSomeAreCloseUps) {
    const int size = 2 * prior_image_size;
    int close_ups = 0;
    for (const ShapeView& view : make_views("guitar", 2, 40, 9, 48)) {
        int left = size, right = 0, top = size, bottom = 0;
        for (const std::uint16_t pixel : view.pixel) {
            left = std::min(left, pixel % size), right = std::max(right, pixel % size);
            top = std::min(top, pixel / size), bottom = std::max(bottom, pixel / size);
        }
        EXPECT_GT(std::max(right - left, bottom - top), .6 * size);
        const bool cut = left == 0 || top == 0 || right == size - 1 || bottom == size - 1;
        if (view.close_up) {
            EXPECT_TRUE(cut);
        }
        close_ups += view.close_up;
    }
    EXPECT_GE(close_ups, 3);
    EXPECT_LE(close_ups, 16);
}

TEST(PriorShapes, ViewsShowTheShapeInTheRightSize) {
    const int view_size = 2 * prior_image_size;
    const std::vector<ShapeView> views = make_views("ball", 3, 3, 9, 48);
    ASSERT_EQ(views.size(), 3u);
    for (const ShapeView& view : views) {
        int low = view_size, high = 0;
        for (std::size_t i = 0; i < view.count(); ++i) {
            low = std::min<int>(low, view.pixel[i] % view_size);
            high = std::max<int>(high, view.pixel[i] % view_size);
            const Vec3 p = view.position_at(i), n = view.normal_at(i);
            EXPECT_LT(glm::length(p), 1.01f);
            // A smooth normal may face away slightly at the silhouette of a coarse mesh.
            EXPECT_GT(glm::dot(n, glm::normalize(view.camera - p)), -.05f);
        }
        const double part = static_cast<double>(high - low + 1) / view_size;
        EXPECT_GT(part, .5);
        EXPECT_LT(part, 1);
        const at::Tensor cells = view.cells.to(at::kFloat);
        EXPECT_EQ(cells.sizes(),
                  (std::vector<std::int64_t>{shape_cell_channels, latent_size, latent_size}));
        const at::Tensor depth = cells[0];
        EXPECT_NEAR(depth.max().item<float>(), 1, .15);
        EXPECT_EQ(depth.min().item<float>(), -1);
    }
}

TEST(Shapes, PatternsLieOnThePlaneThatTheNetworkIsTold) {
    at::manual_seed(3);
    const at::Tensor cells = at::rand({1, shape_cell_channels, 6, 6}) * 2 - 1;
    const at::Tensor told = shape_condition(cells, surface_condition_channels);
    const at::Tensor sine = told[0][4 + 6 * space_waves], sine_up = told[0][6 + 6 * space_waves];
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 6; ++x) {
            const auto at = [&](int channel) { return cells[0][channel][y][x].item<float>(); };
            const Vec2 flat = paint::flat_coordinates({at(1), at(2), at(3)}, {at(4), at(5), at(6)});
            EXPECT_NEAR(sine[y][x].item<float>(), std::sin(2 * pi * flat.x), 1e-5);
            EXPECT_NEAR(sine_up[y][x].item<float>(), std::sin(2 * pi * flat.y), 1e-5);
        }
    }
}

TEST(Shapes, AreNamedInSentences) {
    EXPECT_EQ(shape_named("a Wooden chair with a red seat, on a table"), "chair");
    EXPECT_EQ(shape_named("a shiny golden automobile"), "car");
    EXPECT_EQ(shape_named("a zebra print teapot"), "teapot");
    EXPECT_EQ(shape_named("a red object"), std::nullopt);
    EXPECT_EQ(shape_named("a red spaceship"), std::nullopt);
}

TEST(Shapes, AreModelsInTheUnitSphere) {
    const Model mug = shape_model("mug", 3);
    ASSERT_EQ(mug.primitives.size(), 1u);
    float farthest = 0;
    for (const Vec3& position : mug.primitives[0].positions)
        farthest = std::max(farthest, glm::length(position));
    EXPECT_NEAR(farthest, 1, 1e-4);
}

TEST(Shapes, HeldOutVariantsAreNeverForTraining) {
    const auto of = [](const char* name, bool held_out, int count) {
        const auto index = static_cast<std::size_t>(shape_class_index(name));
        return shape_variants_of(shape_classes()[index], held_out, count);
    };
    const std::vector<int> training = of("mug", false, 40);
    ASSERT_EQ(training.size(), 40u);
    EXPECT_EQ(training.back(), 41);
    for (const int variant : of("mug", true, 40))
        EXPECT_EQ(std::count(training.begin(), training.end(), variant), 0);
    EXPECT_EQ(of("mug", true, 40), (std::vector<int>{training_variants, training_variants + 1}));
    EXPECT_TRUE(of("teapot", false, 40).empty());
    EXPECT_EQ(of("teapot", true, 2), (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace item3d
