// Tests of occlusion against view factors in closed form, and of properties that hold for any
// model.

#include "item3d/render/kernels/occlusion.h"

#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/occlusion/occlusion_grid.h"
#include "item3d/render/render.h"
#include "item3d/render/textured_materials.h"
#include "tests/support/difference.h"
#include "tests/support/reference_images.h"
#include "tests/support/render.h"

#include <omp.h>

namespace item3d {
namespace {

using testing::front_camera;
using testing::make_geometry;
using testing::make_quad;

constexpr float half_pi = pi / 2;

/// Returns options with few points and rays, enough for fast tests.
OcclusionOptions quick(int rays = 64, std::int64_t max_points = 2048) {
    OcclusionOptions options;
    options.rays = rays;
    options.max_points = max_points;
    return options;
}

/// The visible points of a model, and how open they are.
struct Seen {
    Raster raster;
    Surface surface;
    at::Tensor open;
};

Seen look(const Occlusion& occlusion, const Geometry& geometry, const Camera& camera,
          int size = 64) {
    Seen seen;
    seen.raster = rasterize(geometry, {camera}, size, size);
    seen.surface = interpolate_surface(geometry, seen.raster, {camera});
    EXPECT_GT(seen.surface.count(), 0);
    seen.open = occlusion.at(seen.raster, seen.surface);
    return seen;
}

/// Returns a camera at (0, 0, -distance) that looks at the origin.
Camera back_camera(float distance = 3) {
    Camera camera = front_camera(distance);
    camera.camera_to_world[0] = Vec4(-1, 0, 0, 0);
    camera.camera_to_world[2] = Vec4(0, 0, -1, 0);
    camera.camera_to_world[3] = Vec4(0, 0, -distance, 1);
    return camera;
}

/// Returns a floor over [0, depth] x [-1/2, 1/2] at z = 0 that faces +Z. Over it, at x = 0, is a
/// wall that is 1 high and 2 wide. Normals are those of the faces.
Geometry corner_of_planes(float depth) {
    const float d = depth;
    Geometry geometry = make_geometry(
        at::tensor({0.0f, -0.5f, 0.0f, d,    -0.5f, 0.0f, d,    0.5f, 0.0f, 0.0f, 0.5f,  0.0f,
                    0.0f, -1.0f, 0.0f, 0.0f, 1.0f,  0.0f, 0.0f, 1.0f, 1.0f, 0.0f, -1.0f, 1.0f})
            .reshape({8, 3}),
        at::tensor({0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}, at::kLong).reshape({4, 3}));
    geometry.normals = at::zeros({8, 3});
    return geometry;
}

/// Returns the pixels that see the floor of corner_of_planes.
at::Tensor on_floor(const Seen& seen) {
    return seen.surface.position.select(1, 2).abs() < 1e-4f;
}

/// Returns the view factor from a surface element to a perpendicular rectangle of height a and
/// width b. The rectangle stands on the element's plane at the distance c, with one of its lower
/// corners straight before the element.
double perpendicular_rectangle(double a, double b, double c) {
    const double slant = std::sqrt(a * a + c * c);
    return (std::atan(b / c) - c / slant * std::atan(b / slant)) / (2 * pi);
}

TEST(Occlusion, NothingHidesAPlaneOrASphere) {
    const Geometry plane = make_quad(1, 1);
    const Occlusion of_plane(plane, nullptr, quick());
    for (const Camera& camera : {front_camera(), back_camera()})
        EXPECT_EQ(look(of_plane, plane, camera).open.min().item<float>(), 1.0f);

    // The sphere is coarse, so that the hemispheres of its normals reach far below its triangles.
    const Geometry sphere = Geometry::from_model(make_unit_sphere(8, 12));
    const Occlusion of_sphere(sphere, nullptr, quick());
    EXPECT_EQ(look(of_sphere, sphere, front_camera()).open.min().item<float>(), 1.0f);
}

TEST(Occlusion, InsideOfAClosedShapeIsDark) {
    const Geometry sphere = Geometry::from_model(make_unit_sphere(24, 32));
    Camera inside = front_camera(0.0f, half_pi);
    inside.near_plane = 0.01f;
    const Seen seen = look(Occlusion(sphere, nullptr, quick()), sphere, inside);
    EXPECT_EQ(seen.surface.count(), 64 * 64);
    EXPECT_EQ(seen.open.max().item<float>(), 0.0f);
}

TEST(Occlusion, AWallOnAFloorAsItsViewFactor) {
    const Geometry geometry = corner_of_planes(1);
    const OcclusionOptions options = quick(1024, 4096);
    const Seen seen = look(Occlusion(geometry, nullptr, options), geometry, front_camera(), 128);
    const at::Tensor floor = on_floor(seen);
    double sum = 0, largest = 0;
    std::int64_t count = 0;
    for (std::int64_t i = 0; i < seen.surface.count(); ++i) {
        if (!floor[i].item<bool>()) continue;
        const double x = seen.surface.position[i][0].item<double>();
        const double y = seen.surface.position[i][1].item<double>();
        const double expected =
            1 - perpendicular_rectangle(1, 1 - y, x) - perpendicular_rectangle(1, 1 + y, x);
        const double error = std::abs(seen.open[i].item<double>() - expected);
        sum += error;
        largest = std::max(largest, error);
        ++count;
    }
    ASSERT_GT(count, 500);
    // 1,024 stratified rays have an error of less than one percent, and rounding to a byte adds
    // 0.002.
    EXPECT_LT(sum / static_cast<double>(count), 0.004);
    EXPECT_LT(largest, 0.02);
    // At the foot of the wall, half of the light remains within the first step of the grid.
    EXPECT_NEAR(seen.open.masked_select(floor).min().item<double>(), 0.5, 0.03);

    // Nothing occludes the floor from below.
    const Seen below = look(Occlusion(geometry, nullptr, options), geometry, back_camera());
    EXPECT_EQ(below.open.masked_select(on_floor(below)).min().item<float>(), 1.0f);
}

TEST(Occlusion, BottomOfACylinder) {
    constexpr int segments = 64;
    constexpr float depth = 2;
    std::vector<float> positions{0, 0, 0};
    std::vector<std::int32_t> triangles;
    for (int i = 0; i < segments; ++i) {
        const float angle = 2 * pi * static_cast<float>(i) / segments;
        for (const float z : {0.0f, depth})
            positions.insert(positions.end(), {std::cos(angle), std::sin(angle), z});
        const int a = 1 + 2 * i, b = 1 + 2 * ((i + 1) % segments);
        for (const int vertex : {0, a, b, a, b, b + 1, a, b + 1, a + 1})
            triangles.push_back(vertex);
    }
    Geometry geometry = make_geometry(at::tensor(positions).reshape({-1, 3}),
                                      at::tensor(triangles).reshape({-1, 3}));
    geometry.normals.zero_();
    const OcclusionOptions options = quick(1024);
    const Seen seen = look(Occlusion(geometry, nullptr, options), geometry, front_camera(8, 0.2f));
    const at::Tensor distance = seen.surface.position.narrow(1, 0, 2).norm(2, 1);
    const at::Tensor middle = (distance < 0.05f).logical_and(on_floor(seen));
    ASSERT_GT(middle.sum().item<std::int64_t>(), 0);
    // The opening is a disc of radius r = 1 at the height h, whose share is r^2 / (r^2 + h^2).
    EXPECT_NEAR(seen.open.masked_select(middle).mean().item<double>(), 1 / (1 + depth * depth),
                0.01);
}

TEST(Occlusion, ThreadsDoNotChangeIt) {
    const Geometry geometry = corner_of_planes(1);
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const at::Tensor alone =
        look(Occlusion(geometry, nullptr, quick()), geometry, front_camera()).open;
    omp_set_num_threads(5);
    const at::Tensor together =
        look(Occlusion(geometry, nullptr, quick()), geometry, front_camera()).open;
    omp_set_num_threads(threads);
    EXPECT_TRUE(at::equal(alone, together));

    OcclusionOptions other = quick();
    other.seed = 1;
    const at::Tensor seeded =
        look(Occlusion(geometry, nullptr, other), geometry, front_camera()).open;
    EXPECT_FALSE(at::equal(alone, seeded));
    EXPECT_LT((alone - seeded).abs().max().item<float>(), 0.1f);
}

TEST(Occlusion, TransparentMaterialsLetLightThrough) {
    Geometry geometry = corner_of_planes(1);
    geometry.triangle_material = at::tensor({0, 0, 1, 1}, at::kInt);
    Model model;
    model.materials.resize(2);
    Material& wall = model.materials[1];
    const auto floor_mean = [&] {
        const Seen seen = look(Occlusion(geometry, &model, quick()), geometry, front_camera());
        return seen.open.masked_select(on_floor(seen)).mean().item<double>();
    };
    const double opaque = floor_mean();
    EXPECT_LT(opaque, 0.9);

    wall.alpha = Material::Alpha::blend;
    wall.base_color_factor.w = 0.5f;
    EXPECT_NEAR(floor_mean(), 0.5 * (1 + opaque), 0.01);

    wall.alpha = Material::Alpha::mask;
    wall.base_color_factor.w = 0.6f;
    EXPECT_EQ(floor_mean(), opaque);
    wall.base_color_factor.w = 0.4f;
    EXPECT_EQ(floor_mean(), 1.0);

    // The texture is opaque only in its lower half. The wall's UVs are (0, -y), and the texture
    // repeats.
    wall.base_color_factor.w = 1;
    wall.base_color_texture = 0;
    Texture& texture = model.textures.emplace_back();
    texture.image = Image(1, 64, 4, 1.0f);
    for (int y = 0; y < 32; ++y)
        texture.image.at(0, y, 3) = 0;
    const double half = floor_mean();
    EXPECT_GT(half, opaque + 0.02);
    EXPECT_LT(half, 0.98);
}

TEST(Occlusion, ALightCastsAShadow) {
    const Geometry geometry = corner_of_planes(2);
    // The light comes from behind the wall, at 45 degrees above the floor: its direction is (-1, 0,
    // 1).
    OcclusionOptions options = quick(64, 16384);
    options.light = Image(128, 64, 3, 0.0f);
    const Vec2 uv = equirectangular_uv(glm::normalize(Vec3(-1, 0, 1)));
    for (int c = 0; c < 3; ++c)
        options.light.at(static_cast<int>(uv.x * 128), static_cast<int>(uv.y * 64), c) = 1000;
    const Seen seen = look(Occlusion(geometry, nullptr, options), geometry, front_camera(4));
    const at::Tensor x = seen.surface.position.select(1, 0), floor = on_floor(seen);
    const at::Tensor shadow = floor.logical_and(x < 0.85f);
    const at::Tensor lit = floor.logical_and(x > 1.15f);
    ASSERT_GT(shadow.sum().item<std::int64_t>(), 20);
    ASSERT_GT(lit.sum().item<std::int64_t>(), 20);
    EXPECT_EQ(seen.open.masked_select(shadow).max().item<float>(), 0.0f);
    EXPECT_EQ(seen.open.masked_select(lit).min().item<float>(), 1.0f);
}

TEST(Occlusion, GridsOfDifferentFinenessMeetWithoutAStep) {
    const Geometry geometry = make_geometry(
        at::tensor({0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 9.0f, 9.0f, 0.0f})
            .reshape({4, 3}),
        at::tensor({0, 1, 2, 2, 1, 3}, at::kLong).reshape({2, 3}));
    const OcclusionGrid grid = make_occlusion_grid(geometry, 0.07f, 1 << 20);
    const int coarse = grid.resolution[0], fine = grid.resolution[1];
    ASSERT_GT(fine, coarse);
    ASSERT_GT(coarse, 1);
    std::vector<std::uint8_t> values(static_cast<std::size_t>(2 * grid.points()));
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<std::uint8_t>(37 * i);
    // At first, points that belong to one group have equal values.
    for (std::size_t g = 0; g + 1 < grid.begin.size(); ++g)
        for (std::int64_t m = grid.begin[g]; m < grid.begin[g + 1]; ++m)
            for (int side = 0; side < 2; ++side)
                values[static_cast<std::size_t>(2 * grid.member[static_cast<std::size_t>(m)] +
                                                side)] =
                    values[static_cast<std::size_t>(
                        2 * grid.member[static_cast<std::size_t>(grid.begin[g])] + side)];
    join_grids(grid, values.data());
    const auto at = [&](std::size_t triangle, int column, int row) {
        return static_cast<double>(values[static_cast<std::size_t>(
            2 *
            (grid.first[triangle] + kernels::grid_index(grid.resolution[triangle], column, row)))]);
    };
    // The edge runs from vertex 1 to vertex 2. These are corners 1 and 2 of the first triangle and
    // corners 1 and 0 of the second.
    for (int step = 0; step <= fine; ++step) {
        const double along = static_cast<double>(step) * coarse / fine;
        const int before = std::min(static_cast<int>(along), coarse - 1);
        const double part = along - before;
        const double expected =
            (1 - part) * at(0, 0, coarse - before) + part * at(0, 0, coarse - before - 1);
        EXPECT_NEAR(at(1, step, fine - step), expected, 0.51) << step;
    }
}

TEST(Occlusion, BringsImagesNearerToPathTracing) {
    const reference_data::ReferenceSet set(reference_data::crops());
    Model model = load_model(set.folder() / "meshes" / "spot" / "spot.obj");
    for (Material& material : model.materials) {
        material.metallic_factor = 0;
        material.roughness_factor = 0.4f;
        material.metallic_roughness_texture = material.occlusion_texture = -1;
    }
    const Geometry geometry = Geometry::from_model(model);
    const Image sky = load_image(set.folder() / "env" / "sky_noon.hdr");
    const EnvironmentLight light = prefilter(sky);
    Camera camera;  // view 4 of the references, from behind
    const float elevation = 5 * pi / 180;
    const auto bounds = model.bounds();
    const Vec3 center = 0.5f * (bounds[0] + bounds[1]);
    float radius = 0;
    for (const Vec3& position : model.primitives[0].positions)
        radius = std::max(radius, glm::length(position - center));
    camera.field_of_view_x = 39.6f * pi / 180;
    camera = orbit_camera(center, radius / std::sin(camera.field_of_view_x / 2) * 1.04f, pi,
                          elevation, camera.field_of_view_x);
    const std::string view = "views_spot_sky_noon/view_04_lambertggx.exr";
    const at::Tensor traced = set.image(view);
    const auto image = [&](std::shared_ptr<const Occlusion> occlusion) {
        RenderOptions options;
        options.width = options.height = 256;
        options.shade.multiple_scattering = false;
        options.occlusion = std::move(occlusion);
        const at::Tensor whole =
            render(geometry, TexturedMaterials(model), light, {camera}, options)[0];
        return set.crop(view, whole.narrow(2, 0, 3));
    };
    // The crop has the whole model on a black background, so the ratio is that of the whole images.
    const auto error = [&](const at::Tensor& shown) {
        return ((shown - traced).abs().mean() / traced.mean()).item<double>();
    };
    OcclusionOptions options = quick(64, 16384);
    const at::Tensor without = image(nullptr);
    const at::Tensor with_ambient = image(std::make_shared<Occlusion>(geometry, &model, options));
    options.light = sky;
    const at::Tensor with_light = image(std::make_shared<Occlusion>(geometry, &model, options));
    const double none = error(without), ambient = error(with_ambient), lit = error(with_light);
    std::printf("[ mean error: none %.3f, ambient %.3f, of the light %.3f ]\n", none, ambient, lit);
    // A larger error would mean that the camera is not the reference's.
    EXPECT_LT(none, 0.25) << testing::difference(without, traced);
    EXPECT_LT(ambient, 0.95 * none) << testing::difference(with_ambient, traced);
    EXPECT_LT(lit, 0.5 * none) << testing::difference(with_light, traced);
}

}  // namespace
}  // namespace item3d
