#include "item3d/reconstruct/shape/flexicubes.h"

#include "item3d/reconstruct/shape/dual_cases.h"
#include "tests/support/reconstruct.h"

#include <bit>
#include <cmath>
#include <set>

namespace item3d {
namespace {

using testing::cube_lattice;
using testing::expect_closed;
using testing::sphere_values;

/// Checks that the mesh is closed and that the triangles around each vertex form one fan.
void expect_manifold(const TriangleMesh& mesh) {
    expect_closed(mesh.triangles);
    const auto* t = mesh.triangles.const_data_ptr<std::int64_t>();
    std::map<std::int64_t, std::map<std::int64_t, std::int64_t>> around;
    for (std::int64_t i = 0; i < mesh.triangles.size(0); ++i)
        for (int c = 0; c < 3; ++c)
            around[t[3 * i + c]][t[3 * i + (c + 1) % 3]] = t[3 * i + (c + 2) % 3];
    for (const auto& [vertex, next] : around) {
        const std::int64_t first = next.begin()->first;
        std::size_t steps = 0;
        std::int64_t at = first;
        do {
            at = next.at(at);
            ++steps;
        } while (at != first && steps <= next.size());
        ASSERT_EQ(steps, next.size());
    }
}

std::int64_t euler_characteristic(const TriangleMesh& mesh) {
    return mesh.positions.size(0) - mesh.triangles.size(0) / 2;
}

TriangleMesh as_mesh(const ExtractedSurface& surface) {
    return {surface.positions.detach(), surface.triangles};
}

at::Tensor torus_values(const at::Tensor& points) {
    const at::Tensor ring = points.narrow(1, 0, 2).norm(2, 1) - 0.6f;
    return (ring.square() + points.select(1, 2).square()).sqrt() - 0.23f;
}

TEST(DualCases, EveryCrossedEdgeIsInOneLoop) {
    int doubled = 0;
    for (int inside = 0; inside < 256; ++inside) {
        for (const bool turned : {false, true}) {
            const DualCase& loops = dual_case(inside, turned);
            std::set<int> found;
            for (int edge = 0; edge < 12; ++edge) {
                const auto [a, b] = cube_edge_ends(edge);
                EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(a ^ b)));
                const bool crossed = (inside >> a & 1) != (inside >> b & 1);
                EXPECT_EQ(loops.loop_of_edge[edge] >= 0, crossed);
                if (crossed) found.insert(loops.loop_of_edge[edge]);
            }
            EXPECT_EQ(static_cast<int>(found.size()), loops.loops);
            EXPECT_LE(loops.loops, 4);
        }
        doubled += dual_case(inside).doubled_face >= 0;
        EXPECT_LT(dual_case(inside, true).doubled_face, 0);
    }
    // These are two of Nielson's classes, with 12 and 24 cubes.
    EXPECT_EQ(doubled, 36);
}

TEST(FlexiCubes, SphereAndTorusAreClosedAndHaveTheirVolume) {
    const Lattice lattice = cube_lattice(24);
    const at::Tensor points = lattice.vertices();
    FlexiCubes cubes(lattice);
    // A mean of crossings lies inside of the surface, so the volume is too small. The error is
    // larger for a tube that is three cells thick.
    const auto expect = [&](const at::Tensor& values, double volume, double part, int euler) {
        for (const TriangleMesh& mesh :
             {as_mesh(cubes.extract(values, points)), cubes.mesh(values, points)}) {
            expect_manifold(mesh);
            EXPECT_EQ(euler_characteristic(mesh), euler);
            EXPECT_NEAR(enclosed_volume(mesh), volume, part * volume);  // so it faces outwards
        }
    };
    expect(sphere_values(points), 4.0 / 3.0 * pi * std::pow(0.7, 3), 0.02, 2);
    expect(torus_values(points), 2 * pi * pi * 0.6 * 0.23 * 0.23, 0.07, 0);
}

TEST(FlexiCubes, AnySignsGiveAManifold) {
    int turned = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Lattice lattice;
        const at::Tensor values = testing::random_values(lattice, seed);
        FlexiCubes cubes(lattice);
        expect_manifold(as_mesh(cubes.extract(values, lattice.vertices())));
        expect_manifold(cubes.mesh(values, lattice.vertices()));
        // The next result is the same, although memory is reused.
        const DualTopology topology = cubes.topology(values);
        EXPECT_TRUE(at::equal(topology.quads, cubes.topology(values).quads));
        // Only faces that are doubled from both sides are changed. Each change adds one vertex.
        const auto* v = values.const_data_ptr<float>();
        std::int64_t plain = 0;
        for (int z = 0; z < 7; ++z)
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 6; ++x) {
                    int inside = 0;
                    for (int c = 0; c < 8; ++c)
                        inside |= (v[((z + (c >> 2)) * 6 + y + (c >> 1 & 1)) * 7 + x + (c & 1)] < 0)
                                  << c;
                    plain += dual_case(inside).loops;
                }
        turned += static_cast<int>(topology.cube_of.size(0) - plain);
    }
    EXPECT_GT(turned, 0);  // otherwise the test would not have covered them
    const Lattice lattice = cube_lattice(4);
    FlexiCubes cubes(lattice);
    EXPECT_EQ(cubes.mesh(at::ones({125}), lattice.vertices()).triangles.size(0), 0);
    EXPECT_EQ(cubes.extract(at::ones({125}), lattice.vertices()).triangles.size(0), 0);
}

TEST(FlexiCubes, VerticesStayInTheirCubesWhateverTheWeights) {
    const Lattice lattice = cube_lattice(12);
    const at::Tensor values = sphere_values(lattice.vertices());
    FlexiCubes cubes(lattice);
    {
        const at::NoGradGuard no_gradient;
        cubes.weights().front().normal_(0, 20);
    }
    const DualTopology topology = cubes.topology(values);
    const at::Tensor positions = cubes.mesh(values, lattice.vertices()).positions;
    const at::Tensor cube = topology.cubes.index_select(0, topology.cube_of);
    const at::Tensor corner =
        at::stack({cube % 12, cube.div(12, "floor") % 12, cube.div(144, "floor")}, 1) *
            lattice.cell -
        1;
    EXPECT_GE((positions - corner).min().item<float>(), -1e-5f);
    EXPECT_LE((positions - corner).max().item<float>(), lattice.cell + 1e-5f);
    expect_manifold(cubes.mesh(values, lattice.vertices()));
}

TEST(FlexiCubes, TheRegulariserIsNothingWhereCrossingsAreEquallyFar) {
    // Only one vertex is inside, so each loop has three crossings, which are equally far from their
    // mean.
    const Lattice lattice = cube_lattice(2);
    at::Tensor values = at::ones({27});
    values[13] = -1.0f;
    FlexiCubes cubes(lattice);
    EXPECT_NEAR(cubes.extract(values, lattice.vertices()).regularizer.item<float>(), 0, 1e-6);
    values[12] = 3.0f;
    EXPECT_GT(cubes.extract(values, lattice.vertices()).regularizer.item<float>(), 0.01f);
}

TEST(FlexiCubes, GradientsAreThoseOfFiniteDifferences) {
    const Lattice lattice = cube_lattice(5);
    at::manual_seed(7);
    at::Tensor values = sphere_values(lattice.vertices());
    // The values keep a distance from zero, so that a small step flips no sign.
    values = at::where(values.abs() < 0.1f, at::full_like(values, 0.1f), values);
    values.set_requires_grad(true);
    at::Tensor vertices = lattice.vertices().set_requires_grad(true);
    FlexiCubes cubes(lattice);
    at::Tensor weights = cubes.weights().front();
    {
        const at::NoGradGuard no_gradient;
        weights.normal_(0, 0.5);
    }
    const at::Tensor probe = at::randn({cubes.extract(values, vertices).positions.size(0), 3});
    const auto weighted_positions = [&](const at::Tensor& v, const at::Tensor& p) {
        return (cubes.extract(v, p).positions * probe).sum();
    };
    const auto regularizer = [&](const at::Tensor& v, const at::Tensor& p) {
        return cubes.extract(v, p).regularizer;
    };
    const auto check = [&](const auto& loss, double tolerance) {
        for (at::Tensor* input : {&values, &vertices, &weights})
            input->mutable_grad() = at::Tensor();
        loss(values, vertices).backward();
        EXPECT_TRUE(weights.grad().is_sparse());
        const at::Tensor weight_gradient = weights.grad().to_dense();
        const at::NoGradGuard no_gradient;
        const at::Tensor kept = weights.clone();
        for (int i = 0; i < 9; ++i) {
            const auto direction = [&](int input, const at::Tensor& like) {
                return i % 3 == input ? 0.3f * at::randn_like(like) : at::zeros_like(like);
            };
            const at::Tensor along_values = direction(0, values);
            const at::Tensor along_vertices = direction(1, vertices);
            const at::Tensor along_weights = direction(2, weights);
            const auto at = [&](float step) {
                weights.copy_(kept + step * along_weights);
                return loss(values + step * along_values, vertices + step * along_vertices)
                    .template item<double>();
            };
            constexpr float step = 2e-3f;
            const double difference = (at(step) - at(-step)) / (2 * step);
            const double gradient =
                (values.grad() * along_values).sum().template item<double>() +
                (vertices.grad() * along_vertices).sum().template item<double>() +
                (weight_gradient * along_weights).sum().template item<double>();
            EXPECT_NEAR(gradient, difference, 0.02 * std::abs(difference) + tolerance) << i;
            weights.copy_(kept);
        }
    };
    check(weighted_positions, 0.02);
    check(regularizer, 2e-3);  // kinks where a crossing is as far as the mean
}

}  // namespace
}  // namespace item3d
