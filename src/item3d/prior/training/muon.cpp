#include "item3d/prior/training/muon.h"

#include "item3d/core/error.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <cmath>

namespace item3d {

torch::Tensor orthogonalized(const torch::Tensor& matrix) {
    ITEM3D_CHECK(matrix.dim() == 2, "a matrix is needed");
    const torch::NoGradGuard no_grad;
    const bool tall = matrix.size(0) > matrix.size(1);
    const torch::Tensor wide = tall ? matrix.t() : matrix;
    torch::Tensor x =
        (wide / (wide.norm() + 1e-7)).to(choose_precision("auto", torch::kCPU)).contiguous();
    for (int i = 0; i < 5; ++i) {
        const torch::Tensor square = x.mm(x.t());
        const torch::Tensor mixed = square * -4.7750 + square.mm(square) * 2.0315;
        x = x * 3.4445 + mixed.mm(x);
    }
    x = x.to(torch::kFloat32);
    return tall ? x.t() : x;
}

float orthogonal_step_scale(std::int64_t rows, std::int64_t columns) {
    return .2f * std::sqrt(static_cast<float>(std::max(rows, columns)));
}

}  // namespace item3d
