#include "item3d/render/image_tensor.h"
#include "item3d/render/kernels/cube.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "tests/support/render.h"

namespace item3d {
namespace {

struct ShadedPoints {
    Surface surface;
    MaterialSample material;
    EnvironmentLight light;
};

/// Returns points with random normals, each seen from a random direction on its visible side.
ShadedPoints random_points(std::int64_t count, bool normal_map) {
    at::manual_seed(21);
    ShadedPoints scene;
    scene.surface.pixel = at::arange(count);
    scene.surface.normal = testing::unit_rows(at::randn({count, 3}));
    scene.surface.view =
        testing::unit_rows(scene.surface.normal * 1.2f + testing::unit_rows(at::randn({count, 3})));
    const at::Tensor sign = (at::rand({count, 1}) < 0.5f).to(at::kFloat) * 2 - 1;
    scene.surface.tangent = at::cat({testing::unit_rows(at::randn({count, 3})), sign}, 1);
    scene.material.base_color = at::rand({count, 3});
    scene.material.orm = at::rand({count, 3}) * 0.85f + 0.1f;
    if (normal_map)
        scene.material.normal =
            testing::unit_rows(at::randn({count, 3}) * 0.2f + at::tensor({0.0f, 0.0f, 1.0f}));
    const at::NoGradGuard no_gradient;
    scene.light = prefilter(testing::smooth_cube(32));
    return scene;
}

EnvironmentLight constant_light(float radiance) {
    return prefilter(at::full({6, 16, 16, 3}, radiance));
}

TEST(Shade, WhiteMetalInAWhiteFurnaceIsWhiteAtAnyRoughness) {
    ShadedPoints scene = random_points(200, false);
    scene.light = constant_light(0.5f);
    scene.material.base_color = at::ones({200, 3});
    scene.material.orm.select(1, 0).fill_(1);
    scene.material.orm.select(1, 2).fill_(1);
    const at::Tensor furnace = shade(scene.surface, scene.material, scene.light);
    EXPECT_LT((furnace - 0.5f).abs().max().item<float>(), 1e-4);
    // Without multiple scattering, rough metal darkens.
    ShadeOptions single;
    single.multiple_scattering = false;
    const at::Tensor darker = shade(scene.surface, scene.material, scene.light, single);
    EXPECT_LT(darker.max().item<float>(), 0.5f + 1e-4f);
    EXPECT_LT(darker.mean().item<float>(), 0.45f);
}

TEST(Shade, TermsOfTheEquation) {
    ShadedPoints scene = random_points(100, false);
    scene.light = constant_light(1);
    scene.material.orm = at::tensor({0.5f, 0.4f, 0.0f}).expand({100, 3});
    scene.material.emissive = at::full({100, 3}, 0.25f);
    scene.surface.view = scene.surface.normal.clone();
    // The viewer looks straight down, so A and B are those of n.v = 1 and roughness 0.4.
    const auto table = bsdf_table().accessor<float, 3>();
    const float y = 0.4f * 256 - 0.5f;
    const int y0 = static_cast<int>(y);
    const float a = std::lerp(table[y0][255][0], table[y0 + 1][255][0], y - static_cast<float>(y0));
    const float b = std::lerp(table[y0][255][1], table[y0 + 1][255][1], y - static_cast<float>(y0));
    const float specular = (0.04f * a + b) * (1 + 0.04f * (1 / (a + b) - 1));
    const at::Tensor expected = 0.5f * (scene.material.base_color + specular) + 0.25f;
    EXPECT_LT(
        (shade(scene.surface, scene.material, scene.light) - expected).abs().max().item<float>(),
        1e-4);
}

/// Returns the radiance of a point by the split sum, in double. kernels::cube_value looks up the
/// cube maps; a test of its own compares it with plain computations.
glm::dvec3 scalar_radiance(const ShadedPoints& scene, std::int64_t i) {
    const auto row = [i](const at::Tensor& rows) {
        const float* at = rows.const_data_ptr<float>() + i * rows.size(1);
        return glm::dvec3(at[0], at[1], at[2]);
    };
    const auto look_up = [](const at::Tensor& map, glm::dvec3 direction) {
        const kernels::CubePoint point = kernels::cube_point(Vec3(direction));
        return glm::dvec3(kernels::cube_value(
            map.const_data_ptr<float>(), kernels::cube_taps(point, static_cast<int>(map.size(1)))));
    };
    const glm::dvec3 surface = row(scene.surface.normal), view = row(scene.surface.view),
                     color = row(scene.material.base_color), orm = row(scene.material.orm);
    glm::dvec3 n = surface;
    if (scene.material.normal.defined()) {
        const glm::dvec3 map = row(scene.material.normal), along = row(scene.surface.tangent);
        const glm::dvec3 tangent = glm::normalize(along - surface * glm::dot(surface, along));
        const double handedness = scene.surface.tangent[i][3].item<double>();
        n = glm::normalize(map.x * tangent + map.y * handedness * glm::cross(surface, tangent) +
                           map.z * surface);
    }
    const double cosine = glm::dot(n, view), n_dot_v = std::max(cosine, 1e-3);
    const double occlusion = orm.x, roughness = orm.y, metallic = orm.z;

    // The lobe's lean (Lagarde and de Rousiers 2014), faded in by a smooth step from roughness 0.25
    // to 0.5.
    const double smoothness = 1 - roughness * roughness;
    const double mirror = smoothness * (std::sqrt(smoothness) + roughness * roughness);
    const double x = std::clamp((roughness - 0.25) / 0.25, 0.0, 1.0), fade = x * x * (3 - 2 * x);
    const glm::dvec3 mirrored = 2 * cosine * n - view;
    const glm::dvec3 reflected = glm::mix(n, mirrored, 1 + fade * (mirror - 1));

    // Lagrange's cubic through four levels, over the logarithm of the roughness.
    const std::vector<float>& nodes = scene.light.roughness;
    const double at = std::clamp(std::log(roughness), std::log(double(nodes.front())),
                                 std::log(double(nodes.back())));
    std::size_t first = 0;
    while (first + 4 < nodes.size() && at >= std::log(double(nodes[first + 2])))
        ++first;
    glm::dvec3 specular(0);
    for (std::size_t k = first; k < first + 4; ++k) {
        double weight = 1;
        for (std::size_t j = first; j < first + 4; ++j)
            if (j != k)
                weight *= (at - std::log(double(nodes[j]))) /
                          (std::log(double(nodes[k])) - std::log(double(nodes[j])));
        specular += weight * look_up(scene.light.specular[k], reflected);
    }

    // A and B are interpolated between four texels of the table.
    const auto table = bsdf_table().accessor<float, 3>();
    const double u = std::clamp(n_dot_v * 256 - 0.5, 0.0, 255.0),
                 v = std::clamp(roughness * 256 - 0.5, 0.0, 255.0);
    const auto left = static_cast<int>(std::min(u, 254.0)),
               top = static_cast<int>(std::min(v, 254.0));
    double ab[2];
    for (int c = 0; c < 2; ++c)
        ab[c] = std::lerp(
            std::lerp(double(table[top][left][c]), double(table[top][left + 1][c]), u - left),
            std::lerp(double(table[top + 1][left][c]), double(table[top + 1][left + 1][c]),
                      u - left),
            v - top);
    const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), color, metallic);
    const glm::dvec3 reflectance = (f0 * ab[0] + ab[1]) * (1.0 + f0 * (1 / (ab[0] + ab[1]) - 1));
    return occlusion *
           ((1 - metallic) * color * look_up(scene.light.diffuse, n) + specular * reflectance);
}

TEST(Shade, IsTheSplitSumInDouble) {
    for (const bool normal_map : {false, true}) {
        const ShadedPoints scene = random_points(150, normal_map);
        const at::Tensor found = shade(scene.surface, scene.material, scene.light);
        for (std::int64_t i = 0; i < 150; ++i) {
            const glm::dvec3 expected = scalar_radiance(scene, i);
            for (int c = 0; c < 3; ++c)
                // Directions are in float and look up maps whose slopes are below 10.
                ASSERT_NEAR(found[i][c].item<double>(), expected[c], 2e-5 * (1 + expected[c])) << i;
        }
    }
}

TEST(Shade, AFlatNormalMapChangesNothing) {
    ShadedPoints scene = random_points(100, false);
    const at::Tensor plain = shade(scene.surface, scene.material, scene.light);
    scene.material.normal = at::tensor({0.0f, 0.0f, 1.0f}).expand({100, 3});
    const at::Tensor mapped = shade(scene.surface, scene.material, scene.light);
    EXPECT_LT((plain - mapped).abs().max().item<float>(), 1e-5);
    // The same holds without tangents.
    scene.surface.tangent = at::zeros({100, 4});
    const at::Tensor without = shade(scene.surface, scene.material, scene.light);
    EXPECT_LT((plain - without).abs().max().item<float>(), 1e-5);
}

TEST(Shade, NormalMapsLeanAlongTangentAndBitangent) {
    ShadedPoints scene = random_points(1, false);
    scene.surface.normal = at::tensor({0.0f, 0.0f, 1.0f}).reshape({1, 3});
    scene.surface.view = scene.surface.normal.clone();
    scene.surface.tangent = at::tensor({1.0f, 0.0f, 0.0f, -1.0f}).reshape({1, 4});
    const auto with_map = [&](float x, float y) {
        scene.material.normal = at::tensor({x, y, 0.8f}).reshape({1, 3});
        return shade(scene.surface, scene.material, scene.light);
    };
    const auto with_normal = [&](float x, float y) {
        ShadedPoints bent = scene;
        bent.material.normal = at::Tensor();
        bent.surface.normal = testing::unit_rows(at::tensor({x, y, 0.8f}).reshape({1, 3}));
        return shade(bent.surface, bent.material, bent.light);
    };
    EXPECT_TRUE(at::allclose(with_map(0.6f, 0), with_normal(0.6f, 0), 1e-4, 1e-5));
    // The handedness is -1, so the bitangent is -cross(normal, tangent) = -Y.
    EXPECT_TRUE(at::allclose(with_map(0, 0.6f), with_normal(0, -0.6f), 1e-4, 1e-5));
}

TEST(Shade, IsContinuousInRoughness) {
    ShadedPoints scene = random_points(1, false);
    scene.material.orm[0][2] = 1;
    at::Tensor previous;
    for (int i = 0; i <= 2000; ++i) {
        scene.material.orm[0][1] = static_cast<float>(i) / 2000;
        const at::Tensor value = shade(scene.surface, scene.material, scene.light);
        if (previous.defined()) {
            EXPECT_LT((value - previous).abs().max().item<float>(), 0.01) << i;
        }
        previous = value;
    }
}

TEST(Shade, Gradients) {
    for (const bool multiple_scattering : {true, false}) {
        for (const bool normal_map : {false, true}) {
            const ShadedPoints scene = random_points(60, normal_map);
            ShadeOptions options;
            options.multiple_scattering = multiple_scattering;
            const auto check = [&](const char* name, const at::Tensor& x, auto set,
                                   float step = 5e-5f) {
                SCOPED_TRACE(name);
                testing::check_gradient(
                    [&](const at::Tensor& value) {
                        ShadedPoints changed = scene;
                        set(changed, value);
                        return shade(changed.surface, changed.material, changed.light, options);
                    },
                    x, step, 0.02);
            };
            check("base colour", scene.material.base_color,
                  [](ShadedPoints& s, const at::Tensor& x) { s.material.base_color = x; });
            check("orm", scene.material.orm,
                  [](ShadedPoints& s, const at::Tensor& x) { s.material.orm = x; });
            check("surface normal", scene.surface.normal,
                  [](ShadedPoints& s, const at::Tensor& x) { s.surface.normal = x; });
            if (normal_map)
                check("normal map", scene.material.normal,
                      [](ShadedPoints& s, const at::Tensor& x) { s.material.normal = x; });
            // The loss is linear in the light, so a large step causes nothing but rounding.
            constexpr float light_step = 1e-2f;
            check(
                "diffuse light", scene.light.diffuse,
                [](ShadedPoints& s, const at::Tensor& x) { s.light.diffuse = x; }, light_step);
            for (std::size_t level = 0; level < scene.light.specular.size(); ++level)
                check(
                    "specular light", scene.light.specular[level],
                    [level](ShadedPoints& s, const at::Tensor& x) { s.light.specular[level] = x; },
                    light_step);
        }
    }
}

TEST(Shade, GradientReachesTheCube) {
    ShadedPoints scene = random_points(50, true);
    testing::check_gradient(
        [&](const at::Tensor& cube) {
            return shade(scene.surface, scene.material, prefilter(cube));
        },
        testing::smooth_cube(16), 1e-2f, 1e-3);
}

TEST(Shade, NoPointsGiveNoRadiance) {
    const ShadedPoints scene = random_points(0, true);
    EXPECT_EQ(shade(scene.surface, scene.material, scene.light).sizes(),
              (std::vector<std::int64_t>{0, 3}));
}

TEST(Shade, NamesTheWantedShape) {
    ShadedPoints scene = random_points(5, false);
    scene.material.orm = at::rand({5, 2});
    try {
        shade(scene.surface, scene.material, scene.light);
        FAIL();
    } catch (const std::logic_error& error) {
        EXPECT_NE(std::string(error.what()).find("orm"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("[5, 3]"), std::string::npos);
    }
}

TEST(Scatter, PutsValuesOverBackgroundsWithGradients) {
    const Geometry quad = testing::make_quad(0.5f, 0.5f);
    const std::vector<Camera> cameras{testing::front_camera(), testing::front_camera(5)};
    const Raster raster = rasterize(quad, cameras, 12, 10);
    const Surface surface = interpolate_surface(quad, raster, cameras);
    at::manual_seed(3);
    const at::Tensor values = at::rand({surface.count(), 3});
    const at::Tensor color = at::rand({3}), image = at::rand({2, 10, 12, 3});
    const at::Tensor out = scatter(values, surface, raster, color);
    EXPECT_TRUE(at::equal(out.reshape({-1, 3}).index_select(0, surface.pixel), values));
    EXPECT_TRUE(at::equal(out[0][0][0], color));
    const auto close = [&](auto f, const at::Tensor& x) {
        testing::check_gradient(f, x, 1e-2f, 1e-4);
    };
    close([&](const at::Tensor& x) { return scatter(x, surface, raster, color); }, values);
    close([&](const at::Tensor& x) { return scatter(values, surface, raster, x); }, color);
    close([&](const at::Tensor& x) { return scatter(values, surface, raster, x); }, image);
}

TEST(Srgb, IsTheInverseAndHasBoundedGradients) {
    const at::Tensor x = at::linspace(0, 1, 1001);
    EXPECT_LT((srgb_to_linear(linear_to_srgb(x)) - x).abs().max().item<float>(), 1e-6);
    for (const float value : {0.0f, 0.001f, 0.0031308f, 0.2f, 1.0f})
        EXPECT_NEAR(linear_to_srgb(at::scalar_tensor(value)).item<float>(),
                    item3d::linear_to_srgb(value), 1e-6);
    at::Tensor leaf =
        at::tensor({-1.0f, 0.0f, 1e-8f, 0.003f, 0.0032f, 0.5f, 3.0f}).set_requires_grad(true);
    linear_to_srgb(leaf).sum().backward();
    EXPECT_TRUE(at::isfinite(leaf.grad()).all().item<bool>());
    EXPECT_LE(leaf.grad().max().item<float>(), 12.92f + 1e-3f);
    testing::check_gradient([](const at::Tensor& v) { return linear_to_srgb(v); },
                            at::rand({50}) + 0.05f, 1e-3f, 1e-3);
    testing::check_gradient([](const at::Tensor& v) { return srgb_to_linear(v); },
                            at::rand({50}) + 0.1f, 1e-3f, 1e-3);
}

}  // namespace
}  // namespace item3d
