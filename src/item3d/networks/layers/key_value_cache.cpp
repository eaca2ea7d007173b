#include "item3d/networks/layers/key_value_cache.h"

namespace item3d {

torch::Tensor causal_mask(const torch::Tensor& visible, std::int64_t new_tokens) {
    constexpr double unseen = -1e9;
    const auto total = visible.size(1);
    const auto options = torch::TensorOptions().dtype(torch::kBool).device(visible.device());
    const torch::Tensor later =
        torch::ones({new_tokens, total}, options).triu(total - new_tokens + 1);
    const torch::Tensor hidden = later.unsqueeze(0) | visible.eq(0).unsqueeze(1);
    return torch::zeros(hidden.sizes(), options.dtype(torch::kFloat32))
        .masked_fill(hidden, unseen)
        .unsqueeze(1);
}

}  // namespace item3d
