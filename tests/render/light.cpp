#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/kernels/cube.h"
#include "item3d/render/kernels/zonal.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "tests/support/render.h"

#include <array>

namespace item3d {
namespace {

using kernels::CubeTaps;

Vec3 unit(const at::Tensor& row) {
    return glm::normalize(Vec3(row[0].item<float>(), row[1].item<float>(), row[2].item<float>()));
}

/// Returns the unit directions of a cube map's texels, [6, S, S, 3].
at::Tensor cube_directions(int size) {
    at::Tensor directions = at::empty({6, size, size, 3});
    float* out = directions.data_ptr<float>();
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const Vec3 d = glm::normalize(kernels::cube_direction(
                    face, kernels::texel_centre(x, size), kernels::texel_centre(y, size)));
                for (int c = 0; c < 3; ++c)
                    *out++ = d[c];
            }
    return directions;
}

/// Returns the solid angles of a cube map's texels, [6 S S, 1], up to a common factor.
at::Tensor relative_solid_angles(int size) {
    const at::Tensor texel = (at::arange(size) * 2 + 1).to(at::kDouble) / size - 1;
    return (1 + texel.square().unsqueeze(0) + texel.square().unsqueeze(1))
        .pow(-1.5)
        .expand({6, size, size})
        .reshape({-1, 1});
}

/// Checks that <A x, y> = <x, A^T y> for a linear function A.
template <typename F>
void expect_transposed(const F& f, const at::Tensor& x) {
    at::Tensor leaf = x.clone().set_requires_grad(true);
    const at::Tensor out = f(leaf);
    const at::Tensor weights = at::randn_like(out.detach());
    const at::Tensor forward = (out.to(at::kDouble) * weights).sum();
    (out * weights).sum().backward();
    const double backward = (leaf.grad().to(at::kDouble) * x).sum().item<double>();
    EXPECT_NEAR(forward.item<double>(), backward,
                1e-5 * (out.detach() * weights).abs().sum().item<double>());
}

TEST(BsdfTable, AgreesWithQuadrature) {
    // Reference values {n.v, roughness, A, B} for GGX with height-correlated Smith and Schlick, by
    // a quadrature with 2048 x 1024 nodes.
    constexpr std::array<std::array<float, 4>, 9> reference{{{0.1f, 0.1f, 0.4154012f, 0.5783546f},
                                                             {0.1f, 0.5f, 0.7520172f, 0.1396925f},
                                                             {0.1f, 1.0f, 0.7363443f, 0.0238669f},
                                                             {0.5f, 0.1f, 0.9683176f, 0.0314031f},
                                                             {0.5f, 0.5f, 0.8349162f, 0.0223473f},
                                                             {0.5f, 1.0f, 0.4477051f, 0.0029887f},
                                                             {0.9f, 0.1f, 0.9999372f, 0.0000125f},
                                                             {0.9f, 0.5f, 0.9070364f, 0.0003468f},
                                                             {0.9f, 1.0f, 0.3273410f, 0.0001660f}}};
    const auto table = bsdf_table().accessor<float, 3>();
    for (const auto& [n_dot_v, roughness, scale, bias] : reference) {
        const float x = n_dot_v * 256 - 0.5f, y = std::min(roughness * 256 - 0.5f, 254.999f);
        const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
        for (int c = 0; c < 2; ++c) {
            const float upper =
                std::lerp(table[y0][x0][c], table[y0][x0 + 1][c], x - static_cast<float>(x0));
            const float lower = std::lerp(table[y0 + 1][x0][c], table[y0 + 1][x0 + 1][c],
                                          x - static_cast<float>(x0));
            // At roughness 1, half a texel of the table is missing.
            EXPECT_NEAR(std::lerp(upper, lower, y - static_cast<float>(y0)), c ? bias : scale,
                        roughness == 1.0f ? 3e-3 : 1e-3)
                << n_dot_v << ", " << roughness;
        }
    }
}

TEST(CubeTaps, FacesFollowOpenGL) {
    const Vec3 normals[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int face = 0; face < 6; ++face) {
        EXPECT_EQ(kernels::cube_direction(face, 0, 0), normals[face]);
        for (const float s : {-0.7f, 0.1f})
            for (const float t : {-0.2f, 0.9f}) {
                const Vec3 d = kernels::cube_direction(face, s, t);
                EXPECT_EQ(kernels::cube_face(d), face);
                const CubeTaps taps = kernels::cube_taps(kernels::cube_point(3.0f * d), 1024);
                EXPECT_NEAR(taps.texel[0] % 1024, (s * 0.5 + 0.5) * 1024 - 0.5, 1);
                EXPECT_NEAR(taps.texel[0] / 1024 % 1024, (t * 0.5 + 0.5) * 1024 - 0.5, 1);
            }
    }
    // On the face +Y, t grows towards +Z.
    EXPECT_EQ(kernels::cube_direction(2, 0, 1), Vec3(0, 1, 1));
}

TEST(CubeTaps, DirectionsThatAreNotFiniteStayInTheMap) {
    const float bad[] = {std::nanf(""), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), 0.0f, 3e38f};
    for (const float x : bad)
        for (const float y : bad)
            for (const float z : bad)
                for (const int size : {1, 2, 16}) {
                    const CubeTaps taps = kernels::cube_taps(kernels::cube_point({x, y, z}), size);
                    for (const std::int32_t texel : taps.texel) {
                        EXPECT_GE(texel, 0);
                        EXPECT_LT(texel, 6 * size * size);
                    }
                }
}

TEST(CubeTaps, InterpolateSmoothlyAcrossEdgesAndCorners) {
    constexpr int size = 8;
    at::manual_seed(6);
    const at::Tensor map = at::rand({6, size, size, 3});
    const float* values = map.data_ptr<float>();
    const at::Tensor points = at::randn({4000, 3});
    int crossings = 0;
    for (int i = 0; i < 4000; ++i) {
        // The point is on an edge between two faces, so its two largest components are equal.
        Vec3 d = unit(points[i]);
        const int largest = kernels::cube_face(d) / 2, second = (largest + 1 + i % 2) % 3;
        const int third = 3 - largest - second;
        d[second] = std::copysign(std::abs(d[largest]), d[second]);
        if (i % 3 == 0) d[third] = std::copysign(std::abs(d[largest]) * 0.999f, d[third]);
        Vec3 left = d, right = d;
        left[second] *= 1 + 1e-5f;
        right[second] *= 1 - 1e-5f;
        crossings += kernels::cube_face(left) != kernels::cube_face(right);
        const Vec3 a =
            kernels::cube_value(values, kernels::cube_taps(kernels::cube_point(left), size));
        const Vec3 b =
            kernels::cube_value(values, kernels::cube_taps(kernels::cube_point(right), size));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a[c], b[c], 5e-4) << i;
    }
    EXPECT_GT(crossings, 3000);
}

TEST(CubeTaps, WeightsSumToOneAndGradientByDirection) {
    constexpr int size = 16;
    const at::Tensor map = testing::smooth_cube(size);
    const float* values = map.data_ptr<float>();
    at::manual_seed(9);
    const at::Tensor points = at::randn({500, 6});
    int good = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 d = unit(points[i].narrow(0, 0, 3)), step = unit(points[i].narrow(0, 3, 3));
        const CubeTaps taps = kernels::cube_taps(kernels::cube_point(d), size);
        EXPECT_NEAR(taps.weight[0] + taps.weight[1] + taps.weight[2] + taps.weight[3], 1, 1e-5);
        const Vec3 weights(0.3f, -0.8f, 0.5f);
        const auto value = [&](Vec3 at) {
            return glm::dot(
                weights,
                kernels::cube_value(values, kernels::cube_taps(kernels::cube_point(at), size)));
        };
        const float epsilon = 2e-3f;
        const float numeric =
            (value(d + epsilon * step) - value(d - epsilon * step)) / (2 * epsilon);
        const float analytic =
            glm::dot(step, kernels::cube_direction_gradient(values, taps, weights));
        // Bilinear values have kinks, but most differences do not straddle one.
        good += std::abs(numeric - analytic) < 5e-3f;
    }
    EXPECT_GT(good, 440);
}

TEST(Equirectangular, KeepsDirectionsAndEnergy) {
    constexpr int height = 64;
    Image map(2 * height, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < 2 * height; ++x) {
            const Vec3 d =
                equirectangular_direction((x + 0.5f) / (2 * height), (y + 0.5f) / height);
            for (int c = 0; c < 3; ++c)
                map.at(x, y, c) = 1 + d[c];
        }
    const at::Tensor cube = equirectangular_to_cube(to_tensor(map), 16);
    EXPECT_LT((cube - 1 - cube_directions(16)).abs().max().item<float>(), 0.01);

    // A sun of a single texel is not missed. Its flux arrives for any size of the cube.
    Image sun(2 * height, height, 3);
    sun.at(77, 20, 0) = 1000;
    const double flux = 1000 * std::sin(M_PI * 20.5 / height) * std::pow(M_PI / height, 2);
    for (const int size : {4, 16, 64}) {
        const at::Tensor faces = equirectangular_to_cube(to_tensor(sun), size);
        double sum = 0;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const double s = (2 * x + 1.0) / size - 1, t = (2 * y + 1.0) / size - 1;
                    sum += faces[face][y][x][0].item<float>() * 4.0 / (size * size) /
                           std::pow(1 + s * s + t * t, 1.5);
                }
        EXPECT_NEAR(sum, flux, 0.1 * flux) << size;
    }
}

TEST(Equirectangular, GradientIsTheTranspose) {
    at::manual_seed(1);
    expect_transposed([](const at::Tensor& x) { return equirectangular_to_cube(x, 8); },
                      at::rand({20, 40, 3}));
    // This map is halved before it is sampled.
    expect_transposed([](const at::Tensor& x) { return equirectangular_to_cube(x, 4); },
                      at::rand({64, 128, 3}));
}

TEST(AdjustLight, IsThatOfImages) {
    at::manual_seed(5);
    const at::Tensor map = at::rand({4, 16, 3});
    for (const float degrees : {0.0f, 33.0f, -100.0f, 360.0f, 765.0f}) {
        const Image expected = adjust_light(to_image(map), degrees, -1.5f);
        const at::Tensor found =
            adjust_light(map, at::scalar_tensor(degrees), at::scalar_tensor(-1.5f));
        EXPECT_LT((found - to_tensor(expected)).abs().max().item<float>(), 2e-5f) << degrees;
    }
}

TEST(AdjustLight, GradientsByTexelsAngleAndExposure) {
    at::manual_seed(6);
    const auto real = at::TensorOptions().dtype(at::kDouble);
    const std::array<at::Tensor, 3> at = {at::rand({4, 16, 3}, real), at::scalar_tensor(40.0, real),
                                          at::scalar_tensor(0.7, real)};
    const at::Tensor weights = at::randn({4, 16, 3}, real);
    const auto loss = [&](const std::array<at::Tensor, 3>& x) {
        return (adjust_light(x[0], x[1], x[2]) * weights).sum();
    };
    std::array<at::Tensor, 3> leaves;
    for (std::size_t i = 0; i < 3; ++i)
        leaves[i] = at[i].clone().set_requires_grad(true);
    loss(leaves).backward();
    constexpr double step = 1e-6;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::int64_t k = 0; k < at[i].numel(); k += 7) {
            auto low = at, high = at;
            low[i] = at[i].clone();
            high[i] = at[i].clone();
            low[i].view(-1)[k] -= step;
            high[i].view(-1)[k] += step;
            const double slope = (loss(high) - loss(low)).item<double>() / (2 * step);
            EXPECT_NEAR(leaves[i].grad().view(-1)[k].item<double>(), slope, 1e-7) << i << ' ' << k;
        }
    }
}

/// Tests the gradients of an image of a lit sphere with respect to the light's angle and exposure.
/// They pass through the cube, the prefilter and the shading.
TEST(AdjustLight, GradientsThroughTheImage) {
    at::manual_seed(7);
    const Model sphere = make_unit_sphere(32, 16);
    const Geometry geometry = Geometry::from_model(sphere);
    const std::vector<Camera> cameras{testing::front_camera()};
    const Raster raster = rasterize(geometry, cameras, 24, 24);
    const Surface surface = interpolate_surface(geometry, raster, cameras);
    MaterialSample material;
    material.base_color = at::rand({surface.count(), 3});
    material.orm = at::tensor({1.0f, 0.4f, 0.5f}).repeat({surface.count(), 1});
    const at::Tensor map = to_tensor(make_light_preset("studio", 64));
    const at::Tensor weights = at::rand({surface.count(), 3}, at::kDouble);
    const auto loss = [&](const at::Tensor& degrees, const at::Tensor& exposure) {
        const EnvironmentLight light =
            prefilter(equirectangular_to_cube(adjust_light(map, degrees, exposure), 32));
        return (shade(surface, material, light).to(at::kDouble) * weights).mean();
    };
    // The angle is halfway between two columns, because the interpolation's slope jumps at a
    // column.
    const float angle = 360.0f / 128 * 10.5f;
    at::Tensor degrees = at::scalar_tensor(angle).set_requires_grad(true);
    at::Tensor exposure = at::scalar_tensor(0.3f).set_requires_grad(true);
    loss(degrees, exposure).backward();
    const auto slope = [&](float by_degrees, float by_exposure) {
        const auto at = [&](float sign) {
            return loss(at::scalar_tensor(angle + sign * by_degrees),
                        at::scalar_tensor(0.3f + sign * by_exposure))
                .item<double>();
        };
        return (at(1) - at(-1)) / (2.0 * (by_degrees + by_exposure));
    };
    const double by_degrees = slope(0.8f, 0), by_exposure = slope(0, 0.05f);
    EXPECT_NEAR(degrees.grad().item<double>(), by_degrees, 0.01 * std::abs(by_degrees));
    EXPECT_NEAR(exposure.grad().item<double>(), by_exposure, 0.01 * std::abs(by_exposure));
    EXPECT_GT(std::abs(by_degrees), 1e-5);
}

TEST(Prefilter, KeepsAConstant) {
    const EnvironmentLight light = prefilter(at::full({6, 32, 32, 3}, 0.7f));
    const std::vector<float> roughness{0.08f, 0.5f, 0.63f, 0.79f, 1.0f};
    ASSERT_EQ(light.specular.size(), roughness.size());
    for (std::size_t level = 0; level < roughness.size(); ++level) {
        EXPECT_NEAR(light.roughness[level], roughness[level], 1e-6f);
        EXPECT_EQ(light.specular[level].size(1), 32);
    }
    EXPECT_LT((light.diffuse - 0.7f).abs().max().item<float>(), 1e-5);
    for (const at::Tensor& level : light.specular)
        EXPECT_LT((level - 0.7f).abs().max().item<float>(), 1e-5);
}

TEST(Prefilter, IrradianceOfALinearEnvironment) {
    // For the radiance 1 + a.d, E(n) / pi is 1 + 2/3 a.n.
    const EnvironmentLight light = prefilter(1 + 0.8f * cube_directions(64));
    const at::Tensor expected = 1 + 0.8f * 2 / 3 * cube_directions(128);
    EXPECT_LT((light.diffuse - expected).abs().max().item<float>(), 1e-3);
}

TEST(Prefilter, LobesMatchSampledGgx) {
    // The reference is the mean of d.n under GGX's lobe at n = v = r, by Karis' importance
    // sampling.
    const EnvironmentLight light = prefilter(cube_directions(64));
    ASSERT_EQ(light.specular.size(), 12u);
    for (std::size_t level = 0; level < light.specular.size(); ++level) {
        const double alpha2 = std::pow(light.roughness[level], 4);
        double weighted = 0, total = 0;
        for (int i = 0; i < 100000; ++i) {
            const double u = (i + 0.5) / 100000;
            const double cosine2 = (1 - u) / (1 + (alpha2 - 1) * u);
            const double n_dot_l = 2 * cosine2 - 1;
            if (n_dot_l <= 0) continue;
            weighted += n_dot_l * n_dot_l;
            total += n_dot_l;
        }
        const at::Tensor map = light.specular[level];
        const at::Tensor along = (map * cube_directions(static_cast<int>(map.size(1)))).sum(3);
        EXPECT_NEAR(along.mean().item<float>(), weighted / total, 6e-3) << level;
    }
}

TEST(Prefilter, PyramidSumsAreTheDirectSums) {
    // Suns of one texel in a dim, uneven sky reveal misplaced texels of a coarse level.
    constexpr int size = 64;
    at::manual_seed(4);
    at::Tensor cube = at::rand({6, size, size, 3}) * 0.2f + testing::smooth_cube(size);
    cube[2][20][45] = 800.0f;
    cube[4][3][0] = 300.0f;  // at an edge between faces
    const EnvironmentLight light = prefilter(cube);
    const at::Tensor directions = cube_directions(size).reshape({-1, 3}).to(at::kDouble);
    const at::Tensor angle = relative_solid_angles(size);
    const at::Tensor flux = cube.reshape({-1, 3}).to(at::kDouble) * angle;
    for (std::size_t level = 0; level < light.specular.size(); ++level) {
        const auto level_size = static_cast<int>(light.specular[level].size(1));
        const at::Tensor normals = cube_directions(level_size).reshape({-1, 3});
        const at::Tensor found = light.specular[level].reshape({-1, 3});
        const double alpha2 = std::pow(light.roughness[level], 4);
        double error = 0, total = 0;
        for (std::int64_t i = 5; i < normals.size(0); i += normals.size(0) / 101) {
            const at::Tensor cosine = directions.matmul(normals[i].to(at::kDouble)).clamp_min(0);
            const at::Tensor d = 0.5 * (1 + cosine) * (alpha2 - 1) + 1;
            const at::Tensor weight = (cosine / d.square()).unsqueeze(1);
            const at::Tensor expected = (weight * flux).sum(0) / (weight * angle).sum();
            error += (found[i] - expected).abs().sum().item<double>();
            total += expected.sum().item<double>();
        }
        std::printf("[ roughness %.2f at %d texels: mean difference %.2f %% ]\n",
                    light.roughness[level], level_size, 100 * error / total);
        EXPECT_LT(error / total, 0.006) << "roughness " << light.roughness[level];
    }
}

TEST(Prefilter, GradientIsTheTranspose) {
    at::manual_seed(2);
    for (const int size : {16, 64}) {
        expect_transposed(
            [](const at::Tensor& x) {
                const EnvironmentLight light = prefilter(x);
                std::vector<at::Tensor> flat{light.diffuse.reshape(-1)};
                for (const at::Tensor& level : light.specular)
                    flat.push_back(level.reshape(-1));
                return at::cat(flat);
            },
            at::rand({6, size, size, 3}));
    }
}

/// Returns a dim sky with a sun of a few texels, which is much brighter.
at::Tensor sunny_cube(int size) {
    at::Tensor cube = 0.02f + 0.01f * cube_directions(size);
    cube[2].narrow(0, size / 3, 3).narrow(1, size / 2, 4) += 300.0f;
    return cube;
}

TEST(Prefilter, GradientIsTheTransposeUnderASun) {
    for (const int size : {64, 128})
        expect_transposed([](const at::Tensor& x) { return prefilter(x).diffuse; },
                          sunny_cube(size));
}

TEST(Prefilter, IrradianceWhereASunSets) {
    constexpr int size = 128;
    const at::Tensor cube = sunny_cube(size);
    const at::Tensor found = prefilter(cube).diffuse;
    const auto map_size = static_cast<int>(found.size(1));
    const at::Tensor chosen = at::arange(0, 6 * map_size * map_size, 397);
    const at::Tensor normals =
        cube_directions(map_size).reshape({-1, 3}).index_select(0, chosen).to(at::kDouble);
    const at::Tensor light = cube_directions(size).reshape({-1, 3}).to(at::kDouble);
    const at::Tensor angle = relative_solid_angles(size);
    const at::Tensor cosine = normals.matmul(light.t()).clamp_min(0);
    const at::Tensor expected = cosine.matmul(cube.reshape({-1, 3}) * angle) / cosine.matmul(angle);
    const at::Tensor error =
        (found.reshape({-1, 3}).index_select(0, chosen) - expected).abs() / expected;
    EXPECT_LT(error.max().item<double>(), 0.005);
}

TEST(Prefilter, FindsEveryTexelOfACone) {
    // The ranges of each face are compared with a test of each texel.
    constexpr int size = 32;
    at::manual_seed(3);
    const at::Tensor axes = at::randn({40, 3});
    for (int i = 0; i < 40; ++i) {
        const Vec3 n = unit(axes[i]);
        const float angle = 0.05f + 0.037f * static_cast<float>(i);
        for (int face = 0; face < 6; ++face) {
            const kernels::CubeFrame frame = kernels::cube_frame(face);
            const float normal = glm::dot(frame.normal, n);
            const auto rows =
                kernels::cone_range(glm::dot(frame.t, n), normal, std::sin(angle), size);
            const auto columns =
                kernels::cone_range(glm::dot(frame.s, n), normal, std::sin(angle), size);
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const Vec3 d = glm::normalize(kernels::cube_direction(
                        face, kernels::texel_centre(x, size), kernels::texel_centre(y, size)));
                    if (glm::dot(d, n) <= std::cos(angle)) continue;
                    EXPECT_TRUE(y >= rows.begin && y < rows.end && x >= columns.begin &&
                                x < columns.end)
                        << face << " " << x << " " << y << " angle " << angle;
                }
        }
    }
}

TEST(Prefilter, RefusesOtherSizes) {
    EXPECT_THROW(prefilter(at::ones({6, 24, 24, 3})), std::logic_error);
    EXPECT_THROW(prefilter(at::ones({6, 8, 8, 3})), std::logic_error);
    EXPECT_THROW(prefilter(at::ones({5, 16, 16, 3})), std::logic_error);
}

}  // namespace
}  // namespace item3d
