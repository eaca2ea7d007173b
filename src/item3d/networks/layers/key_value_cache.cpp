#include "item3d/networks/layers/key_value_cache.h"

namespace item3d {

at::Tensor causal_mask(const at::Tensor& visible, std::int64_t new_tokens) {
    constexpr double unseen = -1e9;
    const auto total = visible.size(1);
    const auto options = at::TensorOptions().dtype(at::kBool).device(visible.device());
    const at::Tensor later = at::ones({new_tokens, total}, options).triu(total - new_tokens + 1);
    const at::Tensor hidden = later.unsqueeze(0) | visible.eq(0).unsqueeze(1);
    return at::zeros(hidden.sizes(), options.dtype(at::kFloat))
        .masked_fill(hidden, unseen)
        .unsqueeze(1);
}

}  // namespace item3d
