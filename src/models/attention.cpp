#include "item3d/models/attention.h"

#include "item3d/core/error.h"

#include <cmath>

namespace item3d {

torch::Tensor attention(const torch::Tensor& query, const torch::Tensor& key,
                        const torch::Tensor& value, int heads, const torch::Tensor& mask) {
    ITEM3D_CHECK(query.size(2) % heads == 0, "channels must be a multiple of the heads");
    const auto rows = query.size(0);
    const auto channels = query.size(2);
    const auto width = channels / heads;
    const auto split = [&](const torch::Tensor& x) {  // [N, S, C] -> [N, heads, S, d]
        return x.reshape({rows, x.size(1), heads, width}).transpose(1, 2);
    };
    const torch::Tensor q = split(query), k = split(key), v = split(value);

    const bool needs_gradient = torch::GradMode::is_enabled() &&
                                (q.requires_grad() || k.requires_grad() || v.requires_grad());
    // The plain form keeps its scores for the backward pass: of Stable Diffusion's 4,096 places
    // they would be gigabytes.
    constexpr std::int64_t most_scores = 1 << 24;
    const bool small = rows * heads * query.size(1) * key.size(1) <= most_scores;
    torch::Tensor result;
    if (needs_gradient && q.is_cpu() && small) {
        const double scale = 1.0 / std::sqrt(static_cast<double>(width));
        torch::Tensor scores = torch::matmul(q * scale, k.transpose(2, 3));
        if (mask.defined()) scores = scores + mask;
        result = torch::matmul(scores.softmax(-1), v);
    } else {
        c10::optional<torch::Tensor> bias;
        if (mask.defined()) bias = mask.to(q.scalar_type());
        result = at::scaled_dot_product_attention(q, k, v, bias);
    }
    return result.transpose(1, 2).reshape({rows, query.size(1), channels});
}

}  // namespace item3d
