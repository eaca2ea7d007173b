#include "item3d/reconstruct/shape/lattice.h"

namespace item3d {

at::Tensor Lattice::vertices() const {
    const auto axis = [&](int a) {
        return at::arange(cells[a] + 1, at::kFloat) * cell + origin[a];
    };
    const auto grid = at::meshgrid({axis(2), axis(1), axis(0)}, "ij");
    return at::stack({grid[2], grid[1], grid[0]}, 3).reshape({-1, 3}).contiguous();
}

Lattice Lattice::refined() const {
    return {origin, 0.5f * cell, {2 * cells[0], 2 * cells[1], 2 * cells[2]}};
}

at::Tensor refined_values(const at::Tensor& values, const Lattice& lattice) {
    const auto& n = lattice.cells;
    return at::upsample_trilinear3d(values.view({1, 1, n[2] + 1, n[1] + 1, n[0] + 1}),
                                    {2 * n[2] + 1, 2 * n[1] + 1, 2 * n[0] + 1},
                                    /*align_corners=*/true)
        .reshape({-1});
}

}  // namespace item3d
