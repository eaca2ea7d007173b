#include "item3d/reconstruct/shape/flexicubes.h"

#include "item3d/core/error.h"
#include "item3d/reconstruct/shape/dual_cases.h"

namespace item3d {

namespace {

constexpr std::int64_t alphas = 8, betas = 12, all_weights = alphas + betas + 1;
/// Fraction of the weights' ranges that is used. If it were 1, all weights of a mean could become
/// 0.
constexpr double weight_range = 0.99;

/// Signs of a lattice and its index arithmetic.
class SignedLattice {
  public:
    SignedLattice(const Lattice& lattice, const float* values)
        : cells_(lattice.cells),
          values_(values),
          row_(lattice.cells[0] + 1),
          slice_(row_ * (lattice.cells[1] + 1)) {}

    std::int64_t vertex(const std::array<int, 3>& cube, int corner) const {
        return cube[0] + (corner & 1) + (cube[1] + (corner >> 1 & 1)) * row_ +
               (cube[2] + (corner >> 2)) * slice_;
    }
    std::int64_t index(const std::array<int, 3>& cube) const {
        return (static_cast<std::int64_t>(cube[2]) * cells_[1] + cube[1]) * cells_[0] + cube[0];
    }
    int inside(const std::array<int, 3>& cube) const {
        int bits = 0;
        for (int corner = 0; corner < 8; ++corner)
            if (values_[vertex(cube, corner)] < 0) bits |= 1 << corner;
        return bits;
    }
    bool is_inside(std::int64_t vertex) const { return values_[vertex] < 0; }
    const DualCase& case_of(const std::array<int, 3>& cube, int inside) const {
        const DualCase& plain = dual_case(inside);
        if (plain.doubled_face < 0) return plain;
        const int axis = plain.doubled_face / 2, side = plain.doubled_face % 2;
        std::array<int, 3> other = cube;
        other[axis] += side == 0 ? -1 : 1;
        if (other[axis] < 0 || other[axis] >= cells_[axis]) return plain;
        const bool both = dual_case(this->inside(other)).doubled_face == (plain.doubled_face ^ 1);
        return both ? dual_case(inside, true) : plain;
    }

  private:
    std::array<int, 3> cells_;
    const float* values_;
    std::int64_t row_, slice_;
};

/// Cube that the surface crosses.
struct CrossedCube {
    std::array<int, 3> place;
    const DualCase* loops;
    std::int64_t first_vertex;
};

/// Lists of a DualTopology, cube by cube and edge by edge.
struct DualLists {
    std::vector<CrossedCube> crossed;
    std::vector<std::int64_t> cube_of, loop, edge, corners, ends, quads, quad_ends;

    void add_cube(const SignedLattice& lattice, const std::array<int, 3>& place,
                  std::vector<std::int32_t>& row_of_cube) {
        const int inside = lattice.inside(place);
        if (inside == 0 || inside == 255) return;
        const auto row = static_cast<std::int32_t>(crossed.size());
        const auto first = static_cast<std::int64_t>(cube_of.size());
        const DualCase& loops = lattice.case_of(place, inside);
        row_of_cube[static_cast<std::size_t>(lattice.index(place))] = row;
        crossed.push_back({place, &loops, first});
        for (int l = 0; l < loops.loops; ++l) {
            cube_of.push_back(row);
            for (int e = 0; e < betas; ++e) {
                if (loops.loop_of_edge[e] != l) continue;
                auto [in, out] = cube_edge_ends(e);
                if ((inside >> in & 1) == 0) std::swap(in, out);
                loop.push_back(first + l);
                edge.push_back(e);
                corners.insert(corners.end(), {in, out});
                ends.insert(ends.end(), {lattice.vertex(place, in), lattice.vertex(place, out)});
            }
        }
    }

    /// Adds the quad of the edge along `axis` from the cube's first corner, if the surface crosses
    /// this edge and four cubes are around the edge.
    void add_quad(const SignedLattice& lattice, const CrossedCube& cube, int axis,
                  const std::vector<std::int32_t>& row_of_cube) {
        const int across = (axis + 1) % 3, up = (axis + 2) % 3;
        if (cube.loops->loop_of_edge[cube_edge(axis, 0)] < 0) return;
        if (cube.place[across] == 0 || cube.place[up] == 0) return;
        // The cubes are listed counter-clockwise as seen against the axis.
        constexpr int steps[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
        std::array<std::int64_t, 4> quad{};
        for (int k = 0; k < 4; ++k) {
            std::array<int, 3> place = cube.place;
            place[across] -= steps[k][0];
            place[up] -= steps[k][1];
            const auto row = row_of_cube[static_cast<std::size_t>(lattice.index(place))];
            const CrossedCube& around = crossed[static_cast<std::size_t>(row)];
            const int lower = steps[k][0] << across | steps[k][1] << up;
            quad[k] = around.first_vertex + around.loops->loop_of_edge[cube_edge(axis, lower)];
        }
        std::int64_t in = lattice.vertex(cube.place, 0);
        std::int64_t out = lattice.vertex(cube.place, 1 << axis);
        if (!lattice.is_inside(in)) {
            std::swap(in, out);
            std::swap(quad[1], quad[3]);
        }
        quads.insert(quads.end(), quad.begin(), quad.end());
        quad_ends.insert(quad_ends.end(), {in, out});
    }

    DualTopology topology(const SignedLattice& lattice) const {
        std::vector<std::int64_t> cubes;
        for (const CrossedCube& cube : crossed)
            cubes.push_back(lattice.index(cube.place));
        const auto list = [](const std::vector<std::int64_t>& values) {
            return at::tensor(values, at::kLong);
        };
        return {list(cubes),
                list(cube_of),
                list(loop),
                list(edge),
                list(corners).reshape({-1, 2}),
                list(ends).reshape({-1, 2}),
                list(quads).reshape({-1, 4}),
                list(quad_ends).reshape({-1, 2})};
    }
};

at::Tensor pick(const at::Tensor& rows, const at::Tensor& index) {
    return rows.index_select(0, index);
}

/// Returns the sum of `values` [K, C] over each loop, [D, C].
at::Tensor sum_loops(const at::Tensor& values, const DualTopology& topology) {
    return at::zeros({topology.cube_of.size(0), values.size(1)})
        .index_add(0, topology.loop, values);
}

}  // namespace

/// Vertices of the surface, with the crossings and weights that determine them.
struct FlexiCubes::Vertices {
    at::Tensor positions;  ///< [D, 3]
    at::Tensor crossings;  ///< [K, 3]
    at::Tensor gamma;      ///< [D, 1]
};

FlexiCubes::FlexiCubes(const Lattice& lattice) : lattice_(lattice) {
    const auto& n = lattice.cells;
    const std::int64_t cubes = static_cast<std::int64_t>(n[0]) * n[1] * n[2];
    weights_ = at::zeros({cubes, all_weights}).set_requires_grad(true);
    row_of_cube_.assign(static_cast<std::size_t>(cubes), -1);
}

DualTopology FlexiCubes::topology(const at::Tensor& values_) {
    const at::Tensor values = values_.detach().contiguous();
    ITEM3D_CHECK(values.scalar_type() == at::kFloat && values.dim() == 1 &&
                     values.size(0) == lattice_.vertex_count(),
                 "one float for each vertex of the lattice");
    const SignedLattice lattice(lattice_, values.const_data_ptr<float>());
    DualLists lists;
    const auto& n = lattice_.cells;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x)
                lists.add_cube(lattice, {x, y, z}, row_of_cube_);
    for (const CrossedCube& cube : lists.crossed)
        for (int axis = 0; axis < 3; ++axis)
            lists.add_quad(lattice, cube, axis, row_of_cube_);
    for (const CrossedCube& cube : lists.crossed)
        row_of_cube_[static_cast<std::size_t>(lattice.index(cube.place))] = -1;
    return lists.topology(lattice);
}

FlexiCubes::Vertices FlexiCubes::dual_vertices(const DualTopology& topology,
                                               const at::Tensor& values,
                                               const at::Tensor& vertices) const {
    // Every cube occurs once, in ascending order, as Adam requires of sparse gradients.
    const at::Tensor rows = at::embedding(weights_, topology.cubes, -1, false, /*sparse=*/true);
    const at::Tensor bounded = 1 + weight_range * at::tanh(rows.narrow(1, 0, alphas + betas));
    const at::Tensor flat = bounded.reshape({-1, 1});
    const at::Tensor first = pick(topology.cube_of, topology.loop) * (alphas + betas);
    const at::Tensor in = topology.corners.select(1, 0), out = topology.corners.select(1, 1);
    const at::Tensor in_vertex = topology.ends.select(1, 0);
    const at::Tensor out_vertex = topology.ends.select(1, 1);

    // A crossing is the point of the edge where the interpolated product of alpha and value is 0
    // (equation 4). The sum of `inner` and `outer` is positive.
    const at::Tensor inner = -pick(values, in_vertex).unsqueeze(1) * pick(flat, first + in);
    const at::Tensor outer = pick(values, out_vertex).unsqueeze(1) * pick(flat, first + out);
    Vertices result;
    result.crossings =
        (pick(vertices, out_vertex) * inner + pick(vertices, in_vertex) * outer) / (inner + outer);
    // A vertex is the mean of its loop's crossings, weighted by beta (equation 5).
    const at::Tensor beta = pick(flat, first + alphas + topology.edge);
    result.positions = sum_loops(beta * result.crossings, topology) / sum_loops(beta, topology);
    const at::Tensor gamma = at::sigmoid(rows.narrow(1, alphas + betas, 1));
    result.gamma = pick(0.5 * (1 - weight_range) + weight_range * gamma, topology.cube_of);
    return result;
}

ExtractedSurface FlexiCubes::extract(const at::Tensor& values, const at::Tensor& vertices) {
    const DualTopology found = topology(values);
    const Vertices dual = dual_vertices(found, values, vertices);
    const auto corner = [&](int k) { return found.quads.select(1, k); };
    const auto position = [&](int k) { return pick(dual.positions, corner(k)); };
    const at::Tensor first = pick(dual.gamma, corner(0)) * pick(dual.gamma, corner(2));
    const at::Tensor second = pick(dual.gamma, corner(1)) * pick(dual.gamma, corner(3));
    const at::Tensor middle =
        0.5 * (first * (position(0) + position(2)) + second * (position(1) + position(3))) /
        (first + second);
    const at::Tensor middles = at::arange(found.quads.size(0), at::kLong) + dual.positions.size(0);
    std::vector<at::Tensor> triangles;
    for (int k = 0; k < 4; ++k)
        triangles.push_back(at::stack({corner(k), corner((k + 1) % 4), middles}, 1));

    const at::Tensor count = sum_loops(at::ones({found.loop.size(0), 1}), found);
    const at::Tensor apart =
        (pick(dual.positions, found.loop) - dual.crossings).norm(2, 1, true) / lattice_.cell;
    const at::Tensor mean = sum_loops(apart, found) / count;
    const at::Tensor deviation = sum_loops((apart - pick(mean, found.loop)).abs(), found) / count;
    return {at::cat({dual.positions, middle}), at::cat(triangles), found.quad_ends,
            deviation.mean()};
}

TriangleMesh FlexiCubes::mesh(const at::Tensor& values, const at::Tensor& vertices) {
    const at::NoGradGuard no_gradient;
    const DualTopology found = topology(values);
    const Vertices dual = dual_vertices(found, values, vertices);
    const auto gamma = [&](int k) {
        return pick(dual.gamma, found.quads.select(1, k)).select(1, 0);
    };
    const at::Tensor first = gamma(0) * gamma(2) > gamma(1) * gamma(3);  // diagonal from 0 to 2
    // Rotates the corners of the remaining quads by one, so that each quad's diagonal begins at
    // corner 0.
    const at::Tensor turned = at::where(first.unsqueeze(1), found.quads,
                                        at::roll(found.quads, /*shifts=*/-1, /*dims=*/1));
    const auto half = [&](int b, int c) {
        return at::stack({turned.select(1, 0), turned.select(1, b), turned.select(1, c)}, 1);
    };
    return {dual.positions, at::cat({half(1, 2), half(2, 3)})};
}

}  // namespace item3d
