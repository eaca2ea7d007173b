// Tests of texture, cube and occlusion lookups against plain computations in double.
#include "item3d/render/kernels/cube.h"
#include "item3d/render/kernels/mipmap.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "item3d/render/texture.h"
#include "tests/support/render.h"

#include <array>
#include <random>

namespace item3d {
namespace {

/// Returns the texel that a wrap mode shows at index i.
std::int64_t scalar_wrap(std::int64_t i, std::int64_t size, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
    const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size;
    const std::int64_t within = (i % period + period) % period;
    return within < size ? within : period - 1 - within;
}

/// Returns the bilinear value at (u, v) of one channel of texels [H, W, C] in float32. If `zero` is
/// true, texels outside are 0.
double scalar_bilinear(const at::Tensor& texels, double u, double v, Wrap wrap_u, Wrap wrap_v,
                       std::int64_t channel, bool zero = false) {
    const auto values = texels.accessor<float, 3>();
    const std::int64_t height = texels.size(0), width = texels.size(1);
    const double x = u * static_cast<double>(width) - 0.5,
                 y = v * static_cast<double>(height) - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
        const auto column = static_cast<std::int64_t>(left) + k % 2,
                   row = static_cast<std::int64_t>(top) + k / 2;
        if (zero && (column < 0 || column >= width || row < 0 || row >= height)) continue;
        const double share =
            (k % 2 != 0 ? x - left : 1 - (x - left)) * (k / 2 != 0 ? y - top : 1 - (y - top));
        sum +=
            share *
            values[scalar_wrap(row, height, wrap_v)][scalar_wrap(column, width, wrap_u)][channel];
    }
    return sum;
}

/// The ellipse that a Jacobian makes of a unit circle: its semi-axes, and the longer one's
/// direction.
struct ScalarEllipse {
    double major, minor, along_x, along_y;
};
/// Returns the ellipse of the Jacobian [[a, b], [c, d]]. Its axis follows from the rotation that
/// makes J J^T diagonal (Jacobi's method).
ScalarEllipse scalar_ellipse(double a, double b, double c, double d) {
    const double angle = 0.5 * std::atan2(2 * (a * c + b * d), a * a + b * b - c * c - d * d);
    const double x = std::cos(angle), y = std::sin(angle);
    const double major = std::hypot(x * a + y * c, x * b + y * d);
    return {major, major > 0 ? std::abs(a * d - b * c) / major : 0.0, x, y};
}

TEST(ScalarTexture, IsBilinearInEachWrapMode) {
    at::manual_seed(31);
    const at::Tensor texture = at::rand({5, 7, 3}), uv = at::rand({200, 2}) * 6 - 2.5f;
    const Wrap wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
    for (const Wrap wrap_u : wraps)
        for (const Wrap wrap_v : wraps) {
            const at::Tensor found = sample_texture(texture, uv, wrap_u, wrap_v);
            const auto at = uv.accessor<float, 2>();
            for (std::int64_t i = 0; i < 200; ++i)
                for (std::int64_t c = 0; c < 3; ++c)
                    // Fractions and four products are in float.
                    ASSERT_NEAR(found[i][c].item<double>(),
                                scalar_bilinear(texture, at[i][0], at[i][1], wrap_u, wrap_v, c),
                                1e-6)
                        << i;
        }
}

TEST(ScalarTexture, AveragesProbesAlongTheLongerAxis) {
    at::manual_seed(32);
    const at::Tensor texture = at::rand({16, 32, 2});
    const std::vector<at::Tensor> levels = texture_pyramid(texture);
    // Levels are means of two by two texels.
    for (std::int64_t y = 0; y < 8; ++y)
        for (std::int64_t x = 0; x < 16; ++x)
            EXPECT_NEAR(levels[1][y][x][1].item<double>(),
                        texture.slice(0, 2 * y, 2 * y + 2)
                            .slice(1, 2 * x, 2 * x + 2)
                            .select(2, 1)
                            .to(at::kDouble)
                            .mean()
                            .item<double>(),
                        1e-6);
    const at::Tensor uv = at::rand({150, 2});
    // Footprints are from a tenth of a texel to the whole texture, long and round.
    const at::Tensor footprint =
        (at::rand({150, 4}) - 0.5f) * at::pow(10.0f, at::rand({150, 1}) * 2.5f - 2.5f);
    const at::Tensor found =
        sample_texture(levels, uv, footprint, Wrap::repeat, Wrap::mirrored_repeat);
    int compared = 0, several = 0;
    for (std::int64_t i = 0; i < 150; ++i) {
        const auto f = [&](int k) { return footprint[i][k].item<double>(); };
        const ScalarEllipse ellipse = scalar_ellipse(f(0) * 32, f(2) * 32, f(1) * 16, f(3) * 16);
        const bool sharp = ellipse.major <= 1;
        const double minor =
            std::max({1.0, ellipse.minor, ellipse.major / kernels::max_texture_probes});
        const double ratio = ellipse.major / minor - 1e-3;
        // At these thresholds, the number of probes and the use of a sharp lookup depend on
        // rounding, as does the direction of a nearly round ellipse.
        if (std::abs(ratio - std::round(ratio)) < 1e-4 || std::abs(ellipse.major - 1) < 1e-4 ||
            (ratio > 1 && ratio < 1.05))
            continue;
        const int probes = sharp ? 1 : std::max(1, static_cast<int>(std::ceil(ratio)));
        const double last = static_cast<double>(levels.size()) - 1;
        const double level = sharp ? 0.0 : std::min(std::log2(minor), last);
        const auto fine = static_cast<std::size_t>(level);
        const double fraction = level - static_cast<double>(fine);
        ++compared;
        several += probes > 1;
        for (std::int64_t c = 0; c < 2; ++c) {
            double sum = 0;
            for (int probe = 0; probe < probes; ++probe) {
                const double along =
                    probes == 1 ? 0.0 : (probe - 0.5 * (probes - 1)) * ellipse.major / probes;
                const double u = uv[i][0].item<double>() + along * ellipse.along_x / 32;
                const double v = uv[i][1].item<double>() + along * ellipse.along_y / 16;
                for (std::size_t k = 0; k < (fraction > 0 ? 2u : 1u); ++k)
                    sum += (k == 0 ? 1 - fraction : fraction) / probes *
                           scalar_bilinear(levels[fine + k], u, v, Wrap::repeat,
                                           Wrap::mirrored_repeat, c);
            }
            // The direction of the axis and the level are in float.
            ASSERT_NEAR(found[i][c].item<double>(), sum, 5e-4) << i;
        }
    }
    EXPECT_GT(compared, 130);
    EXPECT_GT(several, 20);
}

/// A mip map of two views in plain memory, and lookups into it.
struct MipmapCase {
    std::vector<at::Tensor> levels;  ///< [2, H, W, C]
    at::Tensor uv, slopes, bias, values;
    kernels::MipmapParameters p{};

    MipmapCase(kernels::MipmapFilter filter, kernels::MipmapBoundary boundary) {
        at::manual_seed(33);
        levels.push_back(at::rand({2, 8, 16, 3}));
        for (int k = 0; k < 3; ++k)
            levels.push_back(at::rand({2, 4 >> k, 8 >> k, 3}));
        uv = at::rand({80, 2}) * 3 - 1;
        slopes = at::randn({80, 4}) * at::pow(10.0f, at::rand({80, 1}) * 2.5f - 2.5f);
        bias = at::randn({80});
        values = at::empty({80, 3});
        for (std::size_t k = 0; k < levels.size(); ++k)
            p.levels[k] = {levels[k].const_data_ptr<float>(), static_cast<int>(levels[k].size(1)),
                           static_cast<int>(levels[k].size(2)), 0};
        p.level_count = static_cast<int>(levels.size());
        p.channels = 3;
        p.filter = filter;
        p.boundary = boundary;
        p.pixels_per_view = 40;
        p.uv = uv.const_data_ptr<float>();
        p.slopes = slopes.const_data_ptr<float>();
        p.bias = bias.const_data_ptr<float>();
        p.values = values.data_ptr<float>();
    }
};

TEST(ScalarMipmap, IsTrilinearByTheLongerAxis) {
    using kernels::MipmapBoundary;
    for (const MipmapBoundary boundary :
         {MipmapBoundary::wrap, MipmapBoundary::clamp, MipmapBoundary::zero}) {
        const MipmapCase of(kernels::MipmapFilter::linear_mipmap_linear, boundary);
        const Wrap wrap = boundary == MipmapBoundary::wrap ? Wrap::repeat : Wrap::clamp_to_edge;
        int between = 0;
        for (std::int64_t i = 0; i < 80; ++i) {
            kernels::mipmap_forward(of.p, i);
            const auto f = [&](int k) { return of.slopes[i][k].item<double>(); };
            const double axis = scalar_ellipse(16 * f(0), 16 * f(1), 8 * f(2), 8 * f(3)).major;
            const double level = std::clamp(std::log2(axis) + of.bias[i].item<double>(), 0.0, 3.0);
            const auto fine = static_cast<std::size_t>(level);
            const double fraction = level - static_cast<double>(fine);
            between += fraction > 0;
            for (std::int64_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < (fraction > 0 ? 2u : 1u); ++k)
                    sum += (k == 0 ? 1 - fraction : fraction) *
                           scalar_bilinear(of.levels[fine + k][i / 40], of.uv[i][0].item<double>(),
                                           of.uv[i][1].item<double>(), wrap, wrap, c,
                                           boundary == MipmapBoundary::zero);
                // The logarithm of the level is in float.
                ASSERT_NEAR(of.values[i][c].item<double>(), sum, 1e-5) << i;
            }
        }
        EXPECT_GT(between, 8);
    }
}

TEST(ScalarMipmap, NearestIsTheTexelThatContainsThePoint) {
    const MipmapCase of(kernels::MipmapFilter::nearest, kernels::MipmapBoundary::wrap);
    for (std::int64_t i = 0; i < 80; ++i) {
        kernels::mipmap_forward(of.p, i);
        const auto texel = [&](int axis, std::int64_t size) {
            const double at = of.uv[i][axis].item<double>() * static_cast<double>(size);
            return scalar_wrap(static_cast<std::int64_t>(std::floor(at)), size, Wrap::repeat);
        };
        EXPECT_TRUE(at::equal(of.values[i], of.levels[0][i / 40][texel(1, 8)][texel(0, 16)])) << i;
    }
}

/// A point of the cube's surface, and the texel whose centre it is.
struct SurfaceTexel {
    glm::dvec3 at;
    std::int32_t index;
};

/// Returns the centres of all texels according to OpenGL's table of faces (OpenGL 4.6, table 8.19).
std::vector<SurfaceTexel> surface_texels(int size) {
    std::vector<SurfaceTexel> texels;
    for (std::int32_t face = 0; face < 6; ++face)
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column) {
                const double s = (2 * column + 1.0) / size - 1, t = (2 * row + 1.0) / size - 1;
                const glm::dvec3 points[6] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t},
                                              {s, -1, -t}, {s, -t, 1},  {-s, -t, -1}};
                texels.push_back({points[face], (face * size + row) * size + column});
            }
    return texels;
}

std::int32_t nearest_texel(const std::vector<SurfaceTexel>& texels, glm::dvec3 at) {
    const SurfaceTexel* nearest = nullptr;
    for (const SurfaceTexel& texel : texels)
        if (nearest == nullptr || glm::distance(texel.at, at) < glm::distance(nearest->at, at))
            nearest = &texel;
    return nearest->index;
}

TEST(ScalarCube, IsBilinearOnTheUnfoldedSurface) {
    constexpr int size = 5;
    at::manual_seed(34);
    const at::Tensor map = at::rand({6, size, size, 3}), flat = map.reshape({-1, 3});
    const at::Tensor directions = at::randn({400, 3});
    const std::vector<SurfaceTexel> texels = surface_texels(size);
    const glm::dvec3 normals[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    // Directions along a face's columns and rows, from the same table.
    const glm::dvec3 right[6] = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0},
                                 {1, 0, 0},  {1, 0, 0}, {-1, 0, 0}};
    const glm::dvec3 down[6] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1},
                                {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
    int edges = 0, corners = 0;
    for (std::int64_t i = 0; i < 400; ++i) {
        const float* d = directions.const_data_ptr<float>() + 3 * i;
        const glm::dvec3 direction(d[0], d[1], d[2]);
        int face = 0;
        for (int k = 1; k < 6; ++k)
            if (glm::dot(direction, normals[k]) > glm::dot(direction, normals[face])) face = k;
        const glm::dvec3 at = direction / glm::dot(direction, normals[face]);
        const double x = (glm::dot(at, right[face]) + 1) * 0.5 * size - 0.5,
                     y = (glm::dot(at, down[face]) + 1) * 0.5 * size - 0.5;
        const double left = std::floor(x), top = std::floor(y);
        at::Tensor values[4];
        double weight[4];
        int corner = -1;
        for (int k = 0; k < 4; ++k) {
            const double column = left + k % 2, row = top + k / 2;
            weight[k] =
                (k % 2 != 0 ? x - left : 1 - (x - left)) * (k / 2 != 0 ? y - top : 1 - (y - top));
            const bool over_x = column < 0 || column >= size, over_y = row < 0 || row >= size;
            if (over_x && over_y) {
                corner = k;
                continue;
            }
            const double s = (2 * column + 1) / size - 1, t = (2 * row + 1) / size - 1;
            glm::dvec3 point = normals[face] + s * right[face] + t * down[face];
            if (over_x || over_y) {
                ++edges;
                // A point half a texel beyond an edge lies half a texel down the next face.
                point -= normals[face] / double(size);
                if (over_x) point += (s < 0 ? 1 / double(size) : -1 / double(size)) * right[face];
                if (over_y) point += (t < 0 ? 1 / double(size) : -1 / double(size)) * down[face];
            }
            values[k] = flat[nearest_texel(texels, point)].to(at::kDouble);
        }
        if (corner >= 0) {
            ++corners;
            at::Tensor mean = at::zeros({3}, at::kDouble);
            for (int k = 0; k < 4; ++k)
                if (k != corner) mean = mean + values[k] / 3;
            values[corner] = mean;
        }
        at::Tensor expected = at::zeros({3}, at::kDouble);
        for (int k = 0; k < 4; ++k)
            expected = expected + weight[k] * values[k];
        const Vec3 found = kernels::cube_value(
            map.const_data_ptr<float>(),
            kernels::cube_taps(kernels::cube_point(Vec3(d[0], d[1], d[2])), size));
        for (int c = 0; c < 3; ++c)
            // Face coordinates are in float.
            ASSERT_NEAR(found[c], expected[c].item<double>(), 1e-5) << i;
    }
    EXPECT_GT(edges, 50);
    EXPECT_GT(corners, 3);
}

TEST(ScalarEquirectangular, IsTheMeanOfBilinearSamplesBySolidAngle) {
    constexpr int height = 20, width = 40, size = 7, samples = 3, fine = size * samples;
    at::manual_seed(35);
    const at::Tensor map = at::rand({height, width, 3});
    const at::Tensor found = equirectangular_to_cube(map, size);
    const std::vector<SurfaceTexel> points = surface_texels(fine);
    at::Tensor sums = at::zeros({6, size, size, 3}, at::kDouble);
    at::Tensor weights = at::zeros({6, size, size, 1}, at::kDouble);
    for (const SurfaceTexel& point : points) {
        const int face = point.index / (fine * fine), row = point.index / fine % fine / samples,
                  column = point.index % fine / samples;
        const double length = glm::length(point.at), weight = 1 / (length * length * length);
        const double u = std::atan2(point.at.x, -point.at.z) / (2 * M_PI) + 0.5;
        const double v = std::acos(point.at.y / length) / M_PI;
        // Columns repeat, rows do not.
        for (int c = 0; c < 3; ++c)
            sums[face][row][column][c] +=
                weight * scalar_bilinear(map, u, v, Wrap::repeat, Wrap::clamp_to_edge, c);
        weights[face][row][column] += weight;
    }
    // Angles in float are within 1e-6, which is 4e-5 texels of a map of forty columns.
    EXPECT_LT((found - sums / weights).abs().max().item<double>(), 1e-4);
}

TEST(ScalarOcclusion, IsLinearInTheSmallTriangleAroundThePoint) {
    constexpr int resolution = 5, points = (resolution + 1) * (resolution + 2) / 2;
    std::mt19937 random(36);
    std::vector<std::uint8_t> values(2 * points);
    for (std::uint8_t& value : values)
        value = static_cast<std::uint8_t>(random() % 256);
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const float normals[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::int32_t triangles[3] = {0, 1, 2}, seen = 0, steps = resolution;
    const std::int64_t first = 0, pixel = 0;
    // The rows of a triangle's grid get shorter, and follow one another.
    const auto value_at = [&](int column, int row, int side) {
        int index = 0;
        for (int j = 0; j < row; ++j)
            index += resolution + 1 - j;
        return values[static_cast<std::size_t>(2 * (index + column) + side)] / 255.0;
    };
    for (int i = 0; i < 300; ++i) {
        float barycentrics[2] = {static_cast<float>(random() % 1000) / 1000,
                                 static_cast<float>(random() % 1000) / 1000};
        if (barycentrics[0] + barycentrics[1] > 1) {
            barycentrics[0] = 1 - barycentrics[0];
            barycentrics[1] = 1 - barycentrics[1];
        }
        const int side = i % 2;
        const float normal[3] = {0, 0, side == 0 ? 1.0f : -1.0f};
        float openness = -1;
        kernels::occlusion_at({normals, positions, triangles, &first, &steps, values.data(),
                               barycentrics, &seen, &pixel, normal, &openness},
                              0);
        const double x = double(barycentrics[0]) * resolution,
                     y = double(barycentrics[1]) * resolution;
        // The point is in the small triangle where its smallest weight is largest.
        double inside = -1e30, expected = 0;
        for (int row = 0; row < resolution; ++row)
            for (int column = 0; column + row < resolution; ++column) {
                const double right = x - column, down = y - row;
                const double lower = std::min({right, down, 1 - right - down});
                if (lower > inside) {
                    inside = lower;
                    expected = (1 - right - down) * value_at(column, row, side) +
                               right * value_at(column + 1, row, side) +
                               down * value_at(column, row + 1, side);
                }
                if (column + row + 2 > resolution) continue;
                const double upper = std::min({1 - right, 1 - down, right + down - 1});
                if (upper > inside) {
                    inside = upper;
                    expected = (right + down - 1) * value_at(column + 1, row + 1, side) +
                               (1 - right) * value_at(column, row + 1, side) +
                               (1 - down) * value_at(column + 1, row, side);
                }
            }
        // Barycentrics are in float, times differences of up to 1.
        EXPECT_NEAR(openness, expected, 1e-5) << barycentrics[0] << ", " << barycentrics[1];
    }
}

}  // namespace
}  // namespace item3d
