// Tests of the prefilter's sums, halos and resizing against loops over all texels in double.
#include "item3d/render/prefilter/host_backend.h"
#include "item3d/render/prefilter/irradiance_sums.h"
#include "item3d/render/prefilter/specular_sums.h"
#include "tests/support/render.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

using kernels::ZonalKernel;

const PrefilterBackend& host() {
    static const HostBackend backend;
    return backend;
}

/// Returns the planes of a map [6, S, S, 3] times a weight [S, S].
CubePlanes planes_of(const at::Tensor& map, const at::Tensor& weight, bool shared_plane) {
    return to_planes(
        CubeMap::contiguous(map.const_data_ptr<float>(), static_cast<int>(map.size(1))),
        weight.const_data_ptr<float>(), shared_plane, host());
}

/// A random map times weights as planes, with the directions and values of its texels in double.
struct SummedMap {
    int size;
    CubePlanes planes;
    std::vector<glm::dvec3> directions;       ///< [6, S, S], unit
    std::vector<std::array<double, 4>> flux;  ///< three colours, and the shared plane's weight

    explicit SummedMap(int of_size) : size(of_size), planes(of_size, true, host()) {
        at::manual_seed(41);
        const at::Tensor map = at::rand({6, size, size, 3});
        // The weights are the same on each face, whatever its orientation, as solid angles are.
        const at::Tensor centre = (2 * at::arange(size) + 1).to(at::kFloat) / size - 1;
        const at::Tensor weight =
            (1 + centre.square() + centre.square().unsqueeze(1)).pow(-1.5).contiguous();
        planes = planes_of(map, weight, true);
        const auto radiance = map.accessor<float, 4>();
        const auto weights = weight.accessor<float, 2>();
        for (int face = 0; face < 6; ++face)
            for (int row = 0; row < size; ++row)
                for (int column = 0; column < size; ++column) {
                    const double s = (2 * column + 1.0) / size - 1, t = (2 * row + 1.0) / size - 1;
                    const kernels::CubeFrame frame = kernels::cube_frame(face);
                    directions.push_back(glm::normalize(s * glm::dvec3(frame.s) +
                                                        t * glm::dvec3(frame.t) +
                                                        glm::dvec3(frame.normal)));
                    const double w = weights[row][column];
                    const auto value = [&](int c) { return radiance[face][row][column][c] * w; };
                    flux.push_back({value(0), value(1), value(2), w});
                }
    }
};

/// Returns the kernel's value at a squared chord, by its formula in double.
double scalar_kernel(const ZonalKernel& kernel, double d) {
    if (d >= kernel.outer) return 0;
    const auto parabola = [d](const float* c) { return c[0] + c[1] * d + c[2] * d * d; };
    const double n_dot_l = 1 - 0.5 * d, half2 = 0.5 * (1 + n_dot_l);
    const double q = half2 * (kernel.alpha2 - 1.0) + 1;
    const double lobe = std::max(0.0, n_dot_l / (q * q) - kernel.floor);
    return (d < kernel.inner ? parabola(kernel.inner_cap) : lobe) - parabola(kernel.outer_cap);
}

/// Compares planes with the sums of weight(n, l) times flux over all texels. Every `step`-th texel
/// of the planes is checked.
template <typename Weight>
void expect_direct_sums(const CubePlanes& found, const SummedMap& source, const Weight& weight,
                        std::int64_t step, double tolerance) {
    const int size = found.size();
    double worst = 0, largest = 0;
    for (std::int64_t i = 0; i < std::int64_t{6} * size * size; i += step) {
        const kernels::FaceTexel at = kernels::place_of(i, size);
        const kernels::CubeFrame frame = kernels::cube_frame(at.face);
        const double s = (2 * at.column + 1.0) / size - 1, t = (2 * at.row + 1.0) / size - 1;
        const glm::dvec3 n = glm::normalize(s * glm::dvec3(frame.s) + t * glm::dvec3(frame.t) +
                                            glm::dvec3(frame.normal));
        std::array<double, 4> sums{};
        for (std::size_t k = 0; k < source.directions.size(); ++k) {
            const double w = weight(n, source.directions[k]);
            for (std::size_t c = 0; c < 4; ++c)
                sums[c] += w * source.flux[k][c];
        }
        for (int c = 0; c < 4; ++c) {
            const int plane = c < 3 ? 3 * at.face + c : 18;
            const double value = found.view().row(plane, at.row)[at.column],
                         exact = sums[static_cast<std::size_t>(c)];
            worst = std::max(worst, std::abs(value - exact));
            largest = std::max(largest, std::abs(exact));
        }
    }
    EXPECT_GT(largest, 0);
    EXPECT_LT(worst, tolerance * largest);
}

/// Returns a GGX kernel that ends at the squared chord `outer`.
ZonalKernel lobe_up_to(float roughness, float outer) {
    ZonalKernel kernel{};
    kernel.alpha2 = roughness * roughness * roughness * roughness;
    kernel.outer = outer;
    kernel.floor = kernel.profile(outer);
    return kernel;
}

TEST(ScalarZonalSums, NearSumsAreLoopsOverAllTexels) {
    constexpr int size = 64;
    const SummedMap map(size);
    const CubeDirections directions(size, host());
    ZonalKernel split = lobe_up_to(0.3f, 0.006f);
    // Within `inner`, the kernel is a line that meets the lobe. A parabola that ends at `outer` is
    // subtracted.
    split.inner = 0.002f;
    const float slope = 1e5f, rest = 2000;
    split.inner_cap[0] = split.profile(split.inner) - split.floor - slope * split.inner;
    split.inner_cap[1] = slope;
    split.outer_cap[0] = rest;
    split.outer_cap[1] = -2 * rest / split.outer;
    split.outer_cap[2] = rest / (split.outer * split.outer);
    for (const ZonalKernel& kernel : {lobe_up_to(0.2f, 0.006f), split}) {
        CubePlanes lanes(size, true, host());
        const kernels::Planes out = lanes.writable();
        near_sums(map.planes, directions, kernel, nullptr,
                  [&](int row, int column, const float* sums) {
                      for (int plane = 0; plane < out.count; ++plane)
                          std::copy_n(sums + plane * kernels::row_tile, kernels::row_tile,
                                      out.row(plane, row) + column);
                  });
        CubePlanes texels(size, true, host());
        texels.clear();
        add_near_sums(map.planes, directions, kernel, texels);
        // A chord of one texel has a rounding error of 3e-6 of its length, and the lobe depends on
        // up to its fourth power. The chosen step meets texels of all edges and corners.
        const auto weight = [&](glm::dvec3 n, glm::dvec3 l) {
            return scalar_kernel(kernel, glm::dot(n - l, n - l));
        };
        for (const CubePlanes* found : {&lanes, &texels})
            expect_direct_sums(*found, map, weight, 63, 1e-4);
    }
}

TEST(ScalarZonalSums, FarSumsAreLoopsOverAllTexels) {
    const SummedMap map(16);
    for (const ZonalKernel& kernel : {lobe_up_to(0.5f, 0.3f), lobe_up_to(1.0f, 2.0f)})
        expect_direct_sums(
            far_sums(map.planes, kernel), map,
            [&](glm::dvec3 n, glm::dvec3 l) {
                return scalar_kernel(kernel, glm::dot(n - l, n - l));
            },
            7, 2e-5);
}

/// Computes far sums with N lanes, whatever the processor has. The planes are turned as sum_far()
/// turns them.
template <int N>
CubePlanes far_sums_of_lanes(const CubePlanes& map, const ZonalKernel& kernel) {
    const int size = map.size();
    const at::Tensor turned = at::zeros({19 * kernels::far_plane(size)});
    const kernels::TurnParameters turn{map.view(), turned.data_ptr<float>(), 6, size};
    for (std::int64_t i = 0; i < std::int64_t{6} * 19 * size; ++i)
        kernels::turn_planes(turn, i);
    const at::Tensor centres = (2 * at::arange(size) + 1).to(at::kFloat) / size - 1;
    const at::Tensor lengths =
        (1 + centres.square() + centres.square().unsqueeze(1)).rsqrt().contiguous();
    CubePlanes out(size, true, host());
    const kernels::FarParameters p{kernel,
                                   turned.const_data_ptr<float>(),
                                   size,
                                   19,
                                   out.writable(),
                                   centres.const_data_ptr<float>(),
                                   lengths.const_data_ptr<float>(),
                                   std::sin(std::min(kernel.reach(), 0.5f * pi)),
                                   -1};
    for (std::int64_t i = 0; i < size * size; ++i)
        kernels::far_sums<N, false>(p, i);
    return out;
}

/// Computes near sums with N lanes, whatever the processor has.
template <int N>
CubePlanes near_sums_of_lanes(const SummedMap& map, const CubeDirections& directions,
                              const ZonalKernel& kernel) {
    const kernels::NearParameters p{kernel,
                                    directions.data(),
                                    directions.plane_step(),
                                    map.planes.view(),
                                    std::sin(kernel.reach()),
                                    {}};
    CubePlanes found(map.size, true, host());
    const kernels::Planes out = found.writable();
    kernels::NearSums sums;
    for (int row = 0; row < map.size / 2; ++row)
        for (int column = 0; column < map.size; column += kernels::row_tile) {
            kernels::near_sums<N>(p, nullptr, row, column, sums);
            for (int half = 0; half < 2; ++half)
                for (int plane = 0; plane < out.count; ++plane)
                    std::copy_n(sums.rows[half][plane], kernels::row_tile,
                                out.row(plane, half == 0 ? row : map.size - 1 - row) + column);
        }
    return found;
}

TEST(ScalarZonalSums, FourAndEightLanesAreLoopsOverAllTexels) {
    const SummedMap coarse(16), fine(64);
    const ZonalKernel wide = lobe_up_to(0.5f, 0.3f), narrow = lobe_up_to(0.2f, 0.006f);
    const CubeDirections directions(64, host());
    const auto by = [](const ZonalKernel& kernel) {
        return [&kernel](glm::dvec3 n, glm::dvec3 l) {
            return scalar_kernel(kernel, glm::dot(n - l, n - l));
        };
    };
    expect_direct_sums(far_sums_of_lanes<4>(coarse.planes, wide), coarse, by(wide), 7, 2e-5);
    expect_direct_sums(far_sums_of_lanes<8>(coarse.planes, wide), coarse, by(wide), 7, 2e-5);
    expect_direct_sums(near_sums_of_lanes<4>(fine, directions, narrow), fine, by(narrow), 127,
                       1e-4);
    expect_direct_sums(near_sums_of_lanes<8>(fine, directions, narrow), fine, by(narrow), 127,
                       1e-4);
}

TEST(ScalarZonalSums, CosineSumsAreLoopsOverAllTexels) {
    const SummedMap map(16);
    // The result is half the sum of n.l and |n.l|, each of which is rounded as a sum of 1,536
    // floats.
    expect_direct_sums(
        cosine_sums(map.planes, 32), map,
        [](glm::dvec3 n, glm::dvec3 l) { return std::max(0.0, glm::dot(n, l)); }, 29, 2e-5);
}

TEST(ScalarCubePlanes, HalosAreTheNearestTexelsOfTheUnfoldedCube) {
    constexpr int size = 16;
    const SummedMap map(size);
    std::vector<glm::dvec3> centres;  // points on the cube's surface
    for (const glm::dvec3 d : map.directions)
        centres.push_back(d / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
    for (int face = 0; face < 6; ++face)
        for (int side = 0; side < 4; ++side)
            for (int beyond = 0; beyond < CubePlanes::halo; ++beyond)
                for (int along = 0; along < size; along += 3) {
                    const kernels::CubeFrame frame = kernels::cube_frame(face);
                    const glm::dvec3 over = (side % 2 == 0 ? -1.0 : 1.0) *
                                            glm::dvec3(side < 2 ? frame.s : frame.t),
                                     edge(side < 2 ? frame.t : frame.s), normal(frame.normal);
                    // The point is as far down the neighbouring face as the halo's texel is beyond
                    // the edge.
                    const glm::dvec3 at = over + ((2 * along + 1.0) / size - 1) * edge +
                                          (1 - (2 * beyond + 1.0) / size) * normal;
                    std::size_t nearest = 0;
                    for (std::size_t k = 0; k < centres.size(); ++k)
                        if (glm::distance(centres[k], at) < glm::distance(centres[nearest], at))
                            nearest = k;
                    const int off = side % 2 == 0 ? -1 - beyond : size + beyond;
                    const int row = side < 2 ? along : off, column = side < 2 ? off : along;
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(map.planes.view().row(3 * face + c, row)[column],
                                    map.flux[nearest][static_cast<std::size_t>(c)], 1e-6)
                            << "face " << face << ", side " << side << ", " << beyond << " beyond";
                }
}

TEST(ScalarCubePlanes, UpsampledIsTheParabolaThroughThreeTexels) {
    const SummedMap map(16);
    const CubePlanes fine = upsampled(map.planes);
    // Value at x of the parabola through (-1, a), (0, b) and (1, c).
    const auto parabola = [](double a, double b, double c, double x) {
        return b + 0.5 * (c - a) * x + (0.5 * (a + c) - b) * x * x;
    };
    for (int plane = 0; plane < 19; ++plane)
        for (int row = 0; row < 32; ++row)
            for (int column = 0; column < 32; ++column) {
                double rows[3];
                for (int k = 0; k < 3; ++k) {
                    const float* at = map.planes.view().row(plane, row / 2 + k - 1) + column / 2;
                    rows[k] = parabola(at[-1], at[0], at[1], column % 2 != 0 ? 0.25 : -0.25);
                }
                ASSERT_NEAR(fine.view().row(plane, row)[column],
                            parabola(rows[0], rows[1], rows[2], row % 2 != 0 ? 0.25 : -0.25), 2e-6);
            }
}

TEST(ScalarCubePlanes, RestrictedIsTheTransposeOfUpsampled) {
    at::manual_seed(42);
    const auto planes = [](int size) {
        return planes_of(at::rand({6, size, size, 3}), at::ones({size, size}), false);
    };
    const CubePlanes coarse = planes(32), fine = planes(64);
    const auto product = [](const CubePlanes& a, const CubePlanes& b) {
        double sum = 0;
        for (int plane = 0; plane < 18; ++plane)
            for (int y = 0; y < a.size(); ++y)
                for (int x = 0; x < a.size(); ++x)
                    sum +=
                        static_cast<double>(a.view().row(plane, y)[x]) * b.view().row(plane, y)[x];
        return sum;
    };
    const double forward = product(upsampled(coarse), fine);
    EXPECT_NEAR(product(coarse, restricted(fine)), forward, 1e-6 * forward);
}

}  // namespace
}  // namespace item3d
