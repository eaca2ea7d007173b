#include "item3d/networks/layers/attention.h"

#include "item3d/core/error.h"
#include "item3d/kernels/cpu/attention/attention_kernel.h"

#include <ATen/Parallel.h>
#include <ATen/autocast_mode.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

template <typename Number>
const auto& kernel() {
    return kernel_for_this_processor<Number>(
        []<Instructions instructions> { return attention_kernel<instructions, Number>(); });
}

template <typename Number>
torch::Tensor attend_all(const torch::Tensor& query, const torch::Tensor& key,
                         const torch::Tensor& value, int heads) {
    const torch::Tensor q = query.contiguous(), k = key.contiguous(), v = value.contiguous();
    const torch::Tensor result = torch::empty_like(q);
    const AttentionShape shape{q.size(0), heads, q.size(1), k.size(1), q.size(2) / heads};
    // Each part packs the keys anew, which so many queries make up for.
    constexpr std::int64_t queries = 1024;
    const std::int64_t ranges = (shape.queries + queries - 1) / queries;
    at::parallel_for(0, shape.rows * heads * ranges, 1, [&](std::int64_t begin, std::int64_t end) {
        const torch::Tensor scratch =
            torch::empty({kernel<Number>()->scratch(shape)}, torch::kUInt8);
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int64_t head = i / ranges, first = i % ranges * queries;
            const AttentionPart part{head / heads, head % heads, first,
                                     std::min(first + queries, shape.queries)};
            kernel<Number>()->attend(shape, static_cast<const Number*>(q.data_ptr()),
                                     static_cast<const Number*>(k.data_ptr()),
                                     static_cast<const Number*>(v.data_ptr()), part,
                                     static_cast<Number*>(result.data_ptr()), scratch.data_ptr());
        }
    });
    return result;
}

/// Whether attend_all() can do it.
bool ours(const torch::Tensor& query, const torch::Tensor& key, const torch::Tensor& value,
          int heads) {
    const auto dtype = query.scalar_type();
    // On matrix units the library multiplies bfloat16 faster.
    const bool runs = (dtype == torch::kFloat32 && kernel<float>()) ||
                      (dtype == torch::kBFloat16 && kernel<BrainFloat>() && !matrix_units_run());
    return query.is_cpu() && dtype == key.scalar_type() && dtype == value.scalar_type() && runs &&
           query.size(2) / heads % 2 == 0 && key.size(0) == query.size(0) &&
           value.sizes() == key.sizes() && !at::autocast::is_autocast_enabled(at::kCPU);
}

}  // namespace

torch::Tensor attention(const torch::Tensor& query, const torch::Tensor& key,
                        const torch::Tensor& value, int heads, const torch::Tensor& mask) {
    ITEM3D_CHECK(query.size(2) % heads == 0, "channels must be a multiple of the heads");
    const auto rows = query.size(0);
    const auto channels = query.size(2);
    const auto width = channels / heads;
    const bool needs_gradient =
        torch::GradMode::is_enabled() &&
        (query.requires_grad() || key.requires_grad() || value.requires_grad());
    if (!needs_gradient && !mask.defined() && ours(query, key, value, heads))
        return query.scalar_type() == torch::kFloat32
                   ? attend_all<float>(query, key, value, heads)
                   : attend_all<BrainFloat>(query, key, value, heads);

    const auto split = [&](const torch::Tensor& x) {  // [N, S, C] -> [N, heads, S, d]
        return x.reshape({rows, x.size(1), heads, width}).transpose(1, 2);
    };
    const torch::Tensor q = split(query), k = split(key), v = split(value);

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
