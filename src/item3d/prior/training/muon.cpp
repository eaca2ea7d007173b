#include "item3d/prior/training/muon.h"

#include "item3d/core/error.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <cmath>

namespace item3d {

at::Tensor newton_schulz(const at::Tensor& matrix) {
    ITEM3D_CHECK(matrix.dim() == 2, "Muon needs a matrix");
    const at::NoGradGuard no_grad;
    const bool tall = matrix.size(0) > matrix.size(1);
    const at::Tensor wide = tall ? matrix.t() : matrix;
    at::Tensor x =
        (wide / (wide.norm() + 1e-7)).to(choose_precision("auto", matrix.device())).contiguous();
    for (int i = 0; i < 5; ++i) {
        const at::Tensor square = x.mm(x.t());
        const at::Tensor mixed = square * -4.7750 + square.mm(square) * 2.0315;
        x = x * 3.4445 + mixed.mm(x);
    }
    x = x.to(at::kFloat);
    return tall ? x.t() : x;
}

float orthogonal_step_scale(std::int64_t rows, std::int64_t columns) {
    return .2f * std::sqrt(static_cast<float>(std::max(rows, columns)));
}

}  // namespace item3d
