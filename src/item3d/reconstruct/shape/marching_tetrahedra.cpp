#include "item3d/reconstruct/shape/marching_tetrahedra.h"

#include "item3d/core/error.h"

#include <algorithm>

namespace item3d {

namespace {

/// Returns the tetrahedra of a cube, whose corner i is at (i & 1, i >> 1 & 1, i >> 2). The corners
/// of each tetrahedron are on a path from corner 0 to corner 7 along the three axes in some order.
/// If this order is an odd permutation, two corners are exchanged, so that all tetrahedra have a
/// positive volume.
constexpr std::array<std::array<int, 4>, 6> cube_tetrahedra() {
    constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    std::array<std::array<int, 4>, 6> result{};
    for (int i = 0; i < 6; ++i) {
        const int first = 1 << orders[i][0];
        const int second = first | (1 << orders[i][1]);
        result[i] = i < 3 ? std::array{0, first, second, 7} : std::array{0, second, first, 7};
    }
    return result;
}

/// Surface inside one tetrahedron: up to two triangles. Each corner of a triangle is on an edge of
/// the tetrahedron, given by the edge's ends {inside, outside}.
struct TetrahedronCase {
    int triangles = 0;
    int corners[2][3][2] = {};
};

/// Returns a case; bit c of `inside` is set if corner c is inside. The corners are first ordered
/// (inside..., outside...) by an even permutation, which keeps the volume positive. If only corner
/// a is inside, the triangle (ab, ac, ad) faces away from a. If only corner d is outside, the
/// triangle (ad, bd, cd) faces d. If a and b are inside, the quadrilateral ac, ad, bd, bc faces c
/// and d.
constexpr TetrahedronCase tetrahedron_case(int inside) {
    int order[4] = {}, count = 0;
    for (int c = 0; c < 4; ++c)
        if ((inside >> c & 1) != 0) order[count++] = c;
    const int in = count;
    for (int c = 0; c < 4; ++c)
        if ((inside >> c & 1) == 0) order[count++] = c;
    int exchanges = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j)
            exchanges += order[i] > order[j];
    if (exchanges % 2 != 0) {
        // Exchanges two corners of the same side.
        const int i = in == 3 ? 0 : 2;
        const int kept = order[i];
        order[i] = order[i + 1];
        order[i + 1] = kept;
    }
    const auto [a, b, c, d] = order;
    TetrahedronCase result;
    const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
        for (int k = 0; k < 3; ++k)
            for (int end = 0; end < 2; ++end)
                result.corners[result.triangles][k][end] = corners[k][end];
        ++result.triangles;
    };
    if (in == 1) add({{{a, b}, {a, c}, {a, d}}});
    // The triangle goes around the outside corner d, as seen from inside.
    if (in == 3) add({{{a, d}, {b, d}, {c, d}}});
    if (in == 2) {
        add({{{a, c}, {a, d}, {b, d}}});
        add({{{a, c}, {b, d}, {b, c}}});
    }
    return result;
}

constexpr std::array<TetrahedronCase, 16> all_cases() {
    std::array<TetrahedronCase, 16> cases{};
    for (int inside = 0; inside < 16; ++inside)
        cases[inside] = tetrahedron_case(inside);
    return cases;
}

constexpr auto tetrahedra = cube_tetrahedra();
constexpr auto cases = all_cases();
/// Directions of edges from their lower vertex: corners 1 to 7 of a cube.
constexpr int directions = 7;

}  // namespace

MarchingTetrahedra::MarchingTetrahedra(const Lattice& lattice)
    : lattice_(lattice),
      edge_rows_(static_cast<std::size_t>(lattice.vertex_count()) * directions, -1) {}

MarchedTopology MarchingTetrahedra::topology(const at::Tensor& values_) {
    const at::Tensor values = values_.detach().contiguous();
    ITEM3D_CHECK(values.scalar_type() == at::kFloat && values.dim() == 1 &&
                     values.size(0) == lattice_.vertex_count(),
                 "one float for each vertex of the lattice");
    const float* value = values.const_data_ptr<float>();
    const auto& n = lattice_.cells;
    const std::int64_t row = n[0] + 1, slice = row * (n[1] + 1);
    std::int64_t corner_offset[8];
    for (int c = 0; c < 8; ++c)
        corner_offset[c] = (c & 1) + (c >> 1 & 1) * row + (c >> 2) * slice;

    std::vector<std::int64_t> edges, triangles;
    std::vector<std::size_t> touched;
    const auto edge_row = [&](std::int64_t base, int in, int out) {
        // The bits of an edge's lower end are a subset of those of its upper end.
        const int low = in & out;
        const std::size_t key = static_cast<std::size_t>(base + corner_offset[low]) * directions +
                                static_cast<std::size_t>((in ^ out) - 1);
        std::int32_t& found = edge_rows_[key];
        if (found < 0) {
            found = static_cast<std::int32_t>(touched.size());
            touched.push_back(key);
            edges.push_back(base + corner_offset[in]);
            edges.push_back(base + corner_offset[out]);
        }
        return found;
    };
    for (int z = 0; z < n[2]; ++z) {
        for (int y = 0; y < n[1]; ++y) {
            for (int x = 0; x < n[0]; ++x) {
                const std::int64_t base = x + y * row + z * slice;
                int inside = 0;
                for (int c = 0; c < 8; ++c)
                    if (value[base + corner_offset[c]] < 0) inside |= 1 << c;
                if (inside == 0 || inside == 255) continue;
                for (const auto& tetrahedron : tetrahedra) {
                    int signs = 0;
                    for (int c = 0; c < 4; ++c)
                        signs |= (inside >> tetrahedron[c] & 1) << c;
                    const TetrahedronCase& piece = cases[signs];
                    for (int t = 0; t < piece.triangles; ++t)
                        for (const auto& ends : piece.corners[t])
                            triangles.push_back(
                                edge_row(base, tetrahedron[ends[0]], tetrahedron[ends[1]]));
                }
            }
        }
    }
    for (const std::size_t key : touched)
        edge_rows_[key] = -1;
    return {at::tensor(edges, at::kLong).reshape({-1, 2}),
            at::tensor(triangles, at::kLong).reshape({-1, 3})};
}

at::Tensor surface_points(const MarchedTopology& topology, const at::Tensor& values,
                          const at::Tensor& vertices) {
    const at::Tensor in = topology.edges.select(1, 0), out = topology.edges.select(1, 1);
    const at::Tensor inner = values.index_select(0, in).unsqueeze(1);
    const at::Tensor outer = values.index_select(0, out).unsqueeze(1);
    // inner < 0 <= outer, so the difference is positive.
    const at::Tensor weight = outer / (outer - inner);
    return vertices.index_select(0, in) * weight + vertices.index_select(0, out) * (1 - weight);
}

ExtractedSurface MarchingTetrahedra::extract(const at::Tensor& values, const at::Tensor& vertices) {
    const MarchedTopology found = topology(values);
    return {surface_points(found, values, vertices), found.triangles, found.edges, {}};
}

TriangleMesh MarchingTetrahedra::mesh(const at::Tensor& values, const at::Tensor& vertices) {
    const at::NoGradGuard no_gradient;
    const MarchedTopology found = topology(values);
    return {surface_points(found, values, vertices), found.triangles};
}

}  // namespace item3d
