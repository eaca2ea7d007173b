// Tests of projection, barycentrics, attributes of pixels and footprints against plain computations
// in double, which solve three equations for each pixel.
#include "item3d/render/kernels/footprint.h"
#include "item3d/render/kernels/interpolate.h"
#include "item3d/render/kernels/pixel_raster.h"
#include "item3d/render/kernels/project.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace item3d {
namespace {

using glm::dvec3;

/// Barycentrics at a point of the image, and their change for a pixel to the right and a pixel
/// down.
struct ScalarWeights {
    dvec3 weight, by_x, by_y;
};

/// Solves b'_0 p_0 + b'_1 p_1 + b'_2 p_2 = q for the pixel q = (x, y, 1), where p_i are the
/// vertices' (x, y, w). The barycentrics are b' divided by its sum.
ScalarWeights scalar_weights(const std::array<dvec3, 3>& vertices, double column, double row,
                             int width, int height) {
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(vertices[0], vertices[1], vertices[2]));
    const dvec3 q((column + 0.5) * 2 / width - 1, 1 - (row + 0.5) * 2 / height, 1);
    const auto total = [](dvec3 v) { return v.x + v.y + v.z; };
    const dvec3 solution = inverse * q;
    const double sum = total(solution);
    const dvec3 weight = solution / sum;
    return {weight, (inverse[0] - weight * total(inverse[0])) / sum * (2.0 / width),
            -(inverse[1] - weight * total(inverse[1])) / sum * (2.0 / height)};
}

constexpr int raster_width = 17, raster_height = 11;

/// A random triangle in clip space that covers most of the image, with w from 0.5 to 2.
struct ClipCase {
    std::vector<float> clip;  ///< [3, 4]
    std::array<dvec3, 3> vertices;
    int column, row;

    explicit ClipCase(unsigned seed) : clip(12) {
        std::mt19937 random(seed);
        const auto between = [&](float low, float high) {
            return std::uniform_real_distribution<float>(low, high)(random);
        };
        const float at[3][2] = {{-1.5f, -1.2f}, {1.4f, -1.1f}, {0.1f, 1.6f}};
        for (std::size_t k = 0; k < 3; ++k) {
            const float w = between(0.5f, 2);
            clip[4 * k] = w * (at[k][0] + between(-0.2f, 0.2f));
            clip[4 * k + 1] = w * (at[k][1] + between(-0.2f, 0.2f));
            clip[4 * k + 3] = w;
            vertices[k] = dvec3(clip[4 * k], clip[4 * k + 1], clip[4 * k + 3]);
        }
        // The pixel is near the middle, which is inside of every such triangle.
        column = 5 + static_cast<int>(random() % 7);
        row = 4 + static_cast<int>(random() % 4);
    }
    ScalarWeights at_pixel() const {
        return scalar_weights(vertices, column, row, raster_width, raster_height);
    }
};

constexpr std::int32_t three_corners[3] = {0, 1, 2};

TEST(ScalarBarycentrics, AreTheSolutionOfThreeEquationsWithItsGradients) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        SCOPED_TRACE(seed);
        const ClipCase of(seed);
        const ScalarWeights exact = of.at_pixel();
        float weights[3];
        for (int k = 0; k < 3; ++k)
            weights[k] = static_cast<float>(exact.weight[k]);
        const kernels::ClipTriangle triangle(of.clip.data(), three_corners);
        const kernels::DVec3 q =
            kernels::pixel_centre(of.column, of.row, raster_width, raster_height);
        const kernels::WeightSlopes slopes =
            kernels::weight_slopes(triangle, q, weights, raster_width, raster_height);
        // The given weights are rounded to float, so slopes differ slightly.
        for (int k = 0; k < 2; ++k) {
            EXPECT_NEAR(slopes.by_x[k], exact.by_x[k], 1e-6);
            EXPECT_NEAR(slopes.by_y[k], exact.by_y[k], 1e-6);
        }

        // Compares the gradients of a weighted sum of weights and slopes with central differences.
        std::mt19937 random(seed + 1000);
        const auto factor = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
        const double by_weight[3] = {factor(), factor(), factor()};
        const kernels::WeightSlopes by_slope{{10 * factor(), 10 * factor()},
                                             {10 * factor(), 10 * factor()}};
        for (const bool with_slopes : {false, true}) {
            const auto loss = [&](const std::array<dvec3, 3>& vertices) {
                const ScalarWeights w =
                    scalar_weights(vertices, of.column, of.row, raster_width, raster_height);
                double sum = 0;
                for (int k = 0; k < 3; ++k)
                    sum += by_weight[k] * w.weight[k];
                for (int k = 0; with_slopes && k < 2; ++k)
                    sum += by_slope.by_x[k] * w.by_x[k] + by_slope.by_y[k] * w.by_y[k];
                return sum;
            };
            kernels::DVec3 found[3];
            ASSERT_TRUE(kernels::weights_backward(triangle, q, weights, by_weight,
                                                  with_slopes ? &by_slope : nullptr, raster_width,
                                                  raster_height, found));
            for (std::size_t k = 0; k < 3; ++k)
                for (int c = 0; c < 3; ++c) {
                    constexpr double step = 1e-6;
                    std::array<dvec3, 3> low = of.vertices, high = of.vertices;
                    low[k][c] -= step;
                    high[k][c] += step;
                    EXPECT_NEAR(found[k][c], (loss(high) - loss(low)) / (2 * step), 2e-5)
                        << "vertex " << k << ", component " << c << ", slopes " << with_slopes;
                }
        }
    }
}

TEST(ScalarProject, IsTheProductWithAColumnMajorMatrix) {
    std::mt19937 random(5);
    std::vector<float> matrices(2 * 16), positions(7 * 3), found(2 * 7 * 4);
    for (std::vector<float>* numbers : {&matrices, &positions})
        for (float& value : *numbers)
            value = std::uniform_real_distribution<float>(-2, 2)(random);
    const kernels::ProjectParameters p{positions.data(), matrices.data(), found.data(), 7};
    for (std::int64_t i = 0; i < 14; ++i)
        kernels::project_vertex(p, i);
    for (std::size_t i = 0; i < 14; ++i)
        for (std::size_t row = 0; row < 4; ++row) {
            const float* m = matrices.data() + 16 * (i / 7);
            double sum = m[12 + row];
            for (std::size_t column = 0; column < 3; ++column)
                sum += static_cast<double>(m[4 * column + row]) * positions[3 * (i % 7) + column];
            // The sum has four terms of up to 4, each rounded.
            EXPECT_NEAR(found[4 * i + row], sum, 4e-6);
        }
}

TEST(ScalarInterpolate, IsTheWeightedSumOfTheCornersWithItsGradients) {
    constexpr std::size_t channels = 5;
    for (unsigned seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const ClipCase of(seed);
        const ScalarWeights exact = of.at_pixel();
        std::mt19937 random(seed);
        std::vector<float> attributes(3 * channels), gradient(channels), values(channels);
        for (std::vector<float>* numbers : {&attributes, &gradient})
            for (float& value : *numbers)
                value = std::uniform_real_distribution<float>(-1, 1)(random);
        const std::int64_t pixel = of.row * raster_width + of.column;
        const std::vector<std::int32_t> seen(raster_width * raster_height, 0);
        std::vector<float> barycentrics(2 * seen.size());
        for (int k = 0; k < 2; ++k)
            barycentrics[static_cast<std::size_t>(2 * pixel + k)] =
                static_cast<float>(exact.weight[k]);
        std::vector<float> by_attributes(attributes.size()), by_clip(12);
        kernels::InterpolateParameters p{};
        p.attributes = attributes.data();
        p.positions_clip = of.clip.data();
        p.triangles = three_corners;
        p.barycentrics = barycentrics.data();
        p.triangle = seen.data();
        p.pixel = &pixel;
        p.vertices = 3;
        p.channels = static_cast<int>(channels);
        p.width = raster_width;
        p.height = raster_height;
        p.values = values.data();
        p.value_gradient = gradient.data();
        p.attribute_gradient.values = by_attributes.data();
        p.clip_gradient.values = by_clip.data();
        kernels::interpolate_forward(p, 0);
        kernels::interpolate_backward(p, 0);

        const auto loss = [&](const std::array<dvec3, 3>& vertices) {
            const dvec3 weight =
                scalar_weights(vertices, of.column, of.row, raster_width, raster_height).weight;
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t c = 0; c < channels; ++c)
                    sum += gradient[c] * weight[static_cast<int>(k)] * attributes[channels * k + c];
            return sum;
        };
        for (std::size_t c = 0; c < channels; ++c) {
            double value = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double weight = exact.weight[static_cast<int>(k)];
                value += weight * attributes[channels * k + c];
                EXPECT_NEAR(by_attributes[channels * k + c], weight * gradient[c], 1e-6);
            }
            EXPECT_NEAR(values[c], value, 1e-6);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            // The gradient is with respect to x, y and w of clip space; z has none.
            const float found[3] = {by_clip[4 * k], by_clip[4 * k + 1], by_clip[4 * k + 3]};
            for (int c = 0; c < 3; ++c) {
                constexpr double step = 1e-6;
                std::array<dvec3, 3> low = of.vertices, high = of.vertices;
                low[k][c] -= step;
                high[k][c] += step;
                EXPECT_NEAR(found[c], (loss(high) - loss(low)) / (2 * step), 1e-5);
            }
            EXPECT_EQ(by_clip[4 * k + 2], 0.0f);
        }
    }
}

/// Two pixels of a raster, whose attributes have three channels. Two of the channels have slopes.
struct PixelCase {
    static constexpr int channels = 3;
    std::vector<float> raster, slopes, attributes, value_gradient, slope_gradient;
    std::vector<std::int64_t> sloped{2, 0};

    /// Returns the values, then the slopes in x and y of the sloped channels, by the formula a =
    /// b_0 a_0 + b_1 a_1 + (1 - b_0 - b_1) a_2.
    std::vector<double> values(const std::vector<double>& b, const std::vector<double>& by,
                               const std::vector<double>& a) const {
        std::vector<double> result;
        for (std::size_t c = 0; c < channels; ++c)
            result.push_back(b[0] * a[c] + b[1] * a[channels + c] +
                             (1 - b[0] - b[1]) * a[2 * channels + c]);
        for (const std::int64_t channel : sloped)
            for (std::size_t axis = 0; axis < 2; ++axis) {
                const auto c = static_cast<std::size_t>(channel);
                result.push_back(by[axis] * a[c] + by[2 + axis] * a[channels + c] -
                                 (by[axis] + by[2 + axis]) * a[2 * channels + c]);
            }
        return result;
    }
};

TEST(ScalarPixelRaster, AttributesAndSlopesAreTheFormulaWithItsGradients) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const ClipCase of(seed);
        const ScalarWeights exact = of.at_pixel();
        std::mt19937 random(seed);
        const auto numbers = [&](std::size_t count) {
            std::vector<float> result(count);
            for (float& number : result)
                number = std::uniform_real_distribution<float>(-1, 1)(random);
            return result;
        };
        PixelCase pixel;
        // The raster has two pixels, the first of which sees nothing.
        pixel.raster = {
            0, 0, 0, 0, static_cast<float>(exact.weight[0]), static_cast<float>(exact.weight[1]),
            0, 1};
        kernels::RasterSlopeParameters slopes{};
        slopes.positions_clip = of.clip.data();
        slopes.triangles = three_corners;
        slopes.raster = pixel.raster.data();
        // Slopes need a whole image, in which pixel 1 is at the case's place.
        slopes.width = raster_width;
        slopes.height = raster_height;
        std::vector<float> rasters(4 * raster_width * raster_height),
            found_slopes(rasters.size(), 7.0f);
        const auto place = static_cast<std::size_t>(of.row * raster_width + of.column);
        std::copy_n(pixel.raster.begin() + 4, 4, rasters.begin() + 4 * static_cast<long>(place));
        slopes.raster = rasters.data();
        slopes.slopes = found_slopes.data();
        for (std::int64_t i = 0; i < raster_width * raster_height; ++i)
            kernels::raster_slopes(slopes, i);
        for (std::size_t i = 0; i < found_slopes.size(); ++i) {
            const double expected[4] = {exact.by_x[0], exact.by_y[0], exact.by_x[1], exact.by_y[1]};
            EXPECT_NEAR(found_slopes[i], i / 4 == place ? expected[i % 4] : 0.0, 1e-6);
        }

        pixel.attributes = numbers(3 * PixelCase::channels);
        pixel.slopes = numbers(8);
        pixel.value_gradient = numbers(2 * PixelCase::channels);
        pixel.slope_gradient = numbers(8);
        std::vector<float> values(2 * PixelCase::channels, 7.0f), value_slopes(8, 7.0f);
        std::vector<float> by_raster(8), by_slopes(8), by_attributes(pixel.attributes.size());
        kernels::PixelAttributeParameters p{};
        p.attributes = pixel.attributes.data();
        p.pixels_per_view = 2;
        p.channels = PixelCase::channels;
        p.triangles = three_corners;
        p.raster = pixel.raster.data();
        p.slopes = pixel.slopes.data();
        p.sloped = pixel.sloped.data();
        p.sloped_count = 2;
        p.values = values.data();
        p.value_slopes = value_slopes.data();
        p.value_gradient = pixel.value_gradient.data();
        p.value_slope_gradient = pixel.slope_gradient.data();
        p.raster_gradient = by_raster.data();
        p.slope_gradient = by_slopes.data();
        Accumulator sums;
        sums.values = by_attributes.data();
        for (std::int64_t i = 0; i < 2; ++i) {
            kernels::pixel_attributes(p, i);
            kernels::pixel_attributes_backward(p, i, sums);
        }
        const std::vector<double> b(pixel.raster.begin() + 4, pixel.raster.begin() + 6),
            by(pixel.slopes.begin() + 4, pixel.slopes.end()),
            a(pixel.attributes.begin(), pixel.attributes.end());
        const std::vector<double> expected = pixel.values(b, by, a);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(values[i], 0.0f);
            EXPECT_NEAR(values[3 + i], expected[i], 1e-6);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_EQ(value_slopes[i], 0.0f);
            EXPECT_NEAR(value_slopes[4 + i], expected[3 + i], 1e-6);
        }

        // The loss is linear in each argument, so differences are exact for any step.
        const auto loss = [&](const std::vector<double>& weights, const std::vector<double>& slope,
                              const std::vector<double>& attribute) {
            const std::vector<double> v = pixel.values(weights, slope, attribute);
            double sum = 0;
            for (std::size_t i = 0; i < 3; ++i)
                sum += pixel.value_gradient[3 + i] * v[i];
            for (std::size_t i = 0; i < 4; ++i)
                sum += pixel.slope_gradient[4 + i] * v[3 + i];
            return sum;
        };
        const double base = loss(b, by, a);
        const auto moved = [](std::vector<double> at, std::size_t i) {
            at[i] += 1;
            return at;
        };
        for (std::size_t i = 0; i < 2; ++i)
            EXPECT_NEAR(by_raster[4 + i], loss(moved(b, i), by, a) - base, 2e-6);
        for (std::size_t i = 0; i < 4; ++i)
            EXPECT_NEAR(by_slopes[4 + i], loss(b, moved(by, i), a) - base, 2e-6);
        for (std::size_t i = 0; i < a.size(); ++i)
            EXPECT_NEAR(by_attributes[i], loss(b, by, moved(a, i)) - base, 2e-6);
    }
}

TEST(ScalarFootprint, IsTheSlopeOfTheInterpolatedUv) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const ClipCase of(seed);
        const ScalarWeights exact = of.at_pixel();
        const std::vector<float> uvs{0.1f, 0.9f, 3.2f, -0.4f, 0.7f, 2.1f};
        const std::vector<std::int32_t> seen(raster_width * raster_height, 0);
        const std::int64_t pixel = of.row * raster_width + of.column;
        float found[4];
        kernels::FootprintParameters p{};
        p.positions_clip = of.clip.data();
        p.triangles = three_corners;
        p.uvs = uvs.data();
        p.triangle = seen.data();
        p.pixel = &pixel;
        p.vertices = 3;
        p.width = raster_width;
        p.height = raster_height;
        p.footprint = found;
        kernels::uv_footprint(p, 0);
        for (std::size_t c = 0; c < 2; ++c) {
            double right = 0, down = 0;
            for (int k = 0; k < 3; ++k) {
                right += exact.by_x[k] * uvs[2 * static_cast<std::size_t>(k) + c];
                down += exact.by_y[k] * uvs[2 * static_cast<std::size_t>(k) + c];
            }
            // The footprint is computed in double and stored as float.
            EXPECT_NEAR(found[c], right, 1e-6);
            EXPECT_NEAR(found[2 + c], down, 1e-6);
        }
    }
}

}  // namespace
}  // namespace item3d
