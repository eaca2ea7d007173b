#include "item3d/reconstruct/outputs/scores.h"
#include "item3d/reconstruct/shape/find_shape.h"
#include "item3d/reconstruct/shape/marching_tetrahedra.h"
#include "item3d/reconstruct/shape/visual_hull.h"
#include "item3d/reconstruct/surface/movable_mesh.h"
#include "tests/support/box_scene.h"
#include "tests/support/reconstruct.h"

#include <cmath>

namespace item3d {
namespace {

using testing::cube_lattice;
using testing::expect_closed;
using testing::sphere_values;

TriangleMesh march(const Lattice& lattice, const at::Tensor& values) {
    MarchingTetrahedra marching(lattice);
    const MarchedTopology topology = marching.topology(values);
    return {surface_points(topology, values, lattice.vertices()), topology.triangles};
}

TEST(MarchingTetrahedra, SphereIsClosedAndHasItsVolume) {
    const Lattice lattice = cube_lattice(24);
    const TriangleMesh mesh = march(lattice, sphere_values(lattice.vertices()));
    expect_closed(mesh.triangles);
    const double volume = 4.0 / 3.0 * pi * std::pow(0.7, 3);
    EXPECT_NEAR(enclosed_volume(mesh), volume, 0.01 * volume);  // so it faces outwards
    // The Euler characteristic of a sphere is 2.
    EXPECT_EQ(mesh.positions.size(0) - mesh.triangles.size(0) / 2, 2);
}

TEST(MarchingTetrahedra, AnySignsGiveAClosedSurface) {
    Lattice lattice;
    const at::Tensor values = testing::random_values(lattice, 5);
    MarchingTetrahedra marching(lattice);
    const MarchedTopology first = marching.topology(values);
    expect_closed(first.triangles);
    EXPECT_GT(first.triangles.size(0), 100);
    // The next result is the same, although memory is reused.
    EXPECT_TRUE(at::equal(first.triangles, marching.topology(values).triangles));
    EXPECT_EQ(marching.topology(at::ones({lattice.vertex_count()})).triangles.size(0), 0);
}

TEST(MarchingTetrahedra, GradientsAreThoseOfFiniteDifferences) {
    const Lattice lattice = cube_lattice(5);
    at::manual_seed(7);
    at::Tensor values = sphere_values(lattice.vertices());
    // The values keep a distance from zero, so that a small step flips no sign.
    values = at::where(values.abs() < 0.05f, at::full_like(values, 0.05f), values);
    values.set_requires_grad(true);
    at::Tensor vertices = lattice.vertices().set_requires_grad(true);
    MarchingTetrahedra marching(lattice);
    const MarchedTopology topology = marching.topology(values);
    const at::Tensor weights = at::randn({topology.edges.size(0), 3});
    const auto loss = [&](const at::Tensor& v, const at::Tensor& p) {
        return (surface_points(topology, v, p) * weights).sum() +
               sign_change_loss(topology.edges, v);
    };
    loss(values, vertices).backward();
    const at::NoGradGuard no_gradient;
    constexpr float step = 1e-2f;
    for (int i = 0; i < 3; ++i) {
        const at::Tensor along_values = at::randn_like(values) * 0.3f;
        const at::Tensor along_vertices = at::randn_like(vertices) * 0.3f;
        const double difference =
            (loss(values + step * along_values, vertices + step * along_vertices) -
             loss(values - step * along_values, vertices - step * along_vertices))
                .item<double>() /
            (2 * step);
        const double gradient = (values.grad() * along_values).sum().item<double>() +
                                (vertices.grad() * along_vertices).sum().item<double>();
        EXPECT_NEAR(gradient, difference, 0.02 * std::abs(difference) + 0.02);
    }
}

TEST(MarchingTetrahedra, AFinerLatticeHasTheSameSurface) {
    const Lattice lattice = cube_lattice(10);
    const at::Tensor values = sphere_values(lattice.vertices());
    const at::Tensor finer = refined_values(values, lattice);
    ASSERT_EQ(finer.size(0), lattice.refined().vertex_count());
    const TriangleMesh coarse = march(lattice, values), fine = march(lattice.refined(), finer);
    EXPECT_NEAR(enclosed_volume(fine), enclosed_volume(coarse), 0.02 * enclosed_volume(coarse));
}

TEST(Mesh, NeighboursNormalsAndDistances) {
    const Lattice lattice = cube_lattice(16);
    const TriangleMesh sphere = march(lattice, sphere_values(lattice.vertices()));
    const at::Tensor normals = vertex_normals(sphere.positions, sphere.triangles);
    const at::Tensor outwards = (sphere.positions - at::tensor({0.03f, -0.02f, 0.05f})) / 0.7f;
    EXPECT_GT((normals * outwards).sum(1).min().item<float>(), 0.95f);

    const at::Tensor neighbours = mesh_neighbours(sphere.triangles, sphere.positions.size(0));
    const auto* n = neighbours.const_data_ptr<std::int32_t>();
    for (std::int64_t i = 0; i < neighbours.numel(); ++i) {
        ASSERT_GE(n[i], 0);
        ASSERT_EQ(n[n[i]], i);
    }
    EXPECT_LT(chamfer_distance(sphere, sphere, 2000), 0.02);
    TriangleMesh larger = sphere;
    larger.positions = sphere.positions + 0.1f * normals;
    const double apart = chamfer_distance(larger, sphere, 4000);
    const double diagonal = 1.4 * std::sqrt(3.0);
    EXPECT_NEAR(apart, 0.1 / diagonal, 0.01);

    const TriangleMesh simple = simplified(sphere, 300);
    EXPECT_LE(simple.triangles.size(0), 320);
    EXPECT_NEAR(enclosed_volume(simple), enclosed_volume(sphere), 0.05);
}

TEST(Mesh, SpecksGo) {
    const Lattice lattice = cube_lattice(20);
    const at::Tensor points = lattice.vertices();
    const at::Tensor speck = (points - at::tensor({0.85f, 0.85f, 0.85f})).norm(2, 1) - 0.09f;
    const at::Tensor both = at::minimum(sphere_values(points), speck);
    const TriangleMesh mesh = march(lattice, both);
    const TriangleMesh clean = without_specks(mesh, 0.05);
    EXPECT_LT(clean.triangles.size(0), mesh.triangles.size(0));
    EXPECT_LT(clean.positions.max().item<float>(), 0.8f);
    expect_closed(clean.triangles);
}

TEST(CleanMesh, PartsThatFewImagesShowGo) {
    const TriangleMesh mesh = testing::box_mesh(
        {{Vec3(-0.5f), Vec3(0.5f)}, {Vec3(2.0f), Vec3(2.4f)}, {Vec3(3.0f), Vec3(3.4f)}});
    const at::Tensor shown =
        at::cat({at::full({8}, 3.0f), at::full({8}, 9.0f), at::full({8}, 4.0f)});
    const TriangleMesh clean = without_ghosts(mesh, shown, 5);
    EXPECT_EQ(clean.triangles.size(0), 24);  // the largest part stays, whether views show it or not
    EXPECT_LT(clean.positions.max().item<float>(), 2.5f);
}

TEST(VisualHull, DistancesArePixelsFromTheOutline) {
    Image mask(9, 7, 1);
    for (int y = 2; y < 5; ++y)
        for (int x = 3; x < 6; ++x)
            mask.at(x, y, 0) = 1;
    const Image distance = signed_distance(mask);
    EXPECT_FLOAT_EQ(distance.at(4, 3, 0), -1.5f);
    EXPECT_FLOAT_EQ(distance.at(3, 3, 0), -0.5f);
    EXPECT_FLOAT_EQ(distance.at(2, 3, 0), 0.5f);
    EXPECT_FLOAT_EQ(distance.at(1, 0, 0), std::sqrt(8.0f) - 0.5f);
    EXPECT_GT(signed_distance(Image(4, 4, 1)).at(0, 0, 0), 4);
}

/// Returns views of a sphere with the given radius around the origin.
std::vector<Photograph> sphere_views(int count, int size, float radius) {
    std::vector<Photograph> views;
    for (const Camera& camera : testing::ring_of_cameras(count)) {
        Photograph view{camera.name, camera, Image(size, size, 4)};
        const float slope = std::tan(0.5f * camera.field_of_view_x);
        // The outline of a sphere is where a cone from the camera touches it.
        const float outline = radius / std::sqrt(16 - radius * radius) / slope;
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const float u = 2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(size) - 1;
                const float v = 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(size) - 1;
                const bool inside = u * u + v * v < outline * outline;
                for (int c = 0; c < 4; ++c)
                    view.image.at(x, y, c) = inside ? 1.0f : 0.0f;
            }
        }
        views.push_back(std::move(view));
    }
    return views;
}

TEST(VisualHull, OfASphereIsNearlyTheSphere) {
    const VisualHull hull(sphere_views(24, 96, 0.8f));
    const auto bounds = hull.bounds(Vec3(0), 1.2f, "test");
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(bounds[0][axis], -0.85f, 0.15f);
        EXPECT_NEAR(bounds[1][axis], 0.85f, 0.15f);
    }
    const Lattice lattice = make_lattice(bounds, 32);
    const TriangleMesh mesh = march(lattice, hull.distance(lattice.vertices()));
    expect_closed(mesh.triangles);
    const double volume = 4.0 / 3.0 * pi * std::pow(0.8, 3);
    EXPECT_GT(enclosed_volume(mesh), 0.97 * volume);
    EXPECT_LT(enclosed_volume(mesh), 1.2 * volume);
    const auto targets = make_targets(sphere_views(24, 96, 0.8f), bounds);
    EXPECT_GT(mask_overlap(mesh, targets), 0.96);
}

}  // namespace
}  // namespace item3d
