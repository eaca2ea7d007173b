#include "item3d/networks/layers/attention.h"

#include "item3d/core/error.h"
#include "item3d/kernels/cpu/attention/attention_kernel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <ATen/autocast_mode.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

template <typename Number>
const auto& best_attention_kernel() {
    return kernel_for_this_processor<Number>(
        []<InstructionSet instructions> { return attention_kernel<instructions, Number>(); });
}

template <typename Number>
at::Tensor attend_all(const at::Tensor& query, const at::Tensor& key, const at::Tensor& value,
                      int heads) {
    const at::Tensor q = query.contiguous(), k = key.contiguous(), v = value.contiguous();
    const at::Tensor result = at::empty_like(q);
    const AttentionShape shape{q.size(0), heads, q.size(1), k.size(1), q.size(2) / heads};
    // Number of queries per task. Each task packs the keys again, which costs little compared with
    // this number of queries.
    constexpr std::int64_t queries = 1024;
    const std::int64_t ranges = (shape.queries + queries - 1) / queries;
    parallel_ranges(shape.rows * heads * ranges, 1, [&](std::int64_t begin, std::int64_t end) {
        const at::Tensor scratch =
            at::empty({best_attention_kernel<Number>()->scratch(shape)}, at::kByte);
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int64_t head = i / ranges, first = i % ranges * queries;
            const AttentionPart part{head / heads, head % heads, first,
                                     std::min(first + queries, shape.queries)};
            best_attention_kernel<Number>()->attend(
                shape, static_cast<const Number*>(q.data_ptr()),
                static_cast<const Number*>(k.data_ptr()), static_cast<const Number*>(v.data_ptr()),
                part, static_cast<Number*>(result.data_ptr()), scratch.data_ptr());
        }
    });
    return result;
}

/// True if attend_all() supports these inputs.
bool ours(const at::Tensor& query, const at::Tensor& key, const at::Tensor& value, int heads) {
    const auto dtype = query.scalar_type();
    // LibTorch's bfloat16 products are faster on processors with AMX.
    const bool runs =
        (dtype == at::kFloat && best_attention_kernel<float>()) ||
        (dtype == at::kBFloat16 && best_attention_kernel<BFloat16>() && !amx_available());
    return query.is_cpu() && dtype == key.scalar_type() && dtype == value.scalar_type() && runs &&
           query.size(2) / heads % 2 == 0 && key.size(0) == query.size(0) &&
           value.sizes() == key.sizes() && !at::autocast::is_autocast_enabled(at::kCPU);
}

}  // namespace

at::Tensor attention(const at::Tensor& query, const at::Tensor& key, const at::Tensor& value,
                     int heads, const at::Tensor& mask) {
    ITEM3D_CHECK(query.size(2) % heads == 0, "channels must be a multiple of the heads");
    const auto rows = query.size(0);
    const auto channels = query.size(2);
    const auto width = channels / heads;
    const bool needs_gradient =
        at::GradMode::is_enabled() &&
        (query.requires_grad() || key.requires_grad() || value.requires_grad());
    if (!needs_gradient && !mask.defined() && ours(query, key, value, heads))
        return query.scalar_type() == at::kFloat ? attend_all<float>(query, key, value, heads)
                                                 : attend_all<BFloat16>(query, key, value, heads);

    const auto split = [&](const at::Tensor& x) {  // [N, S, C] -> [N, heads, S, d]
        return x.reshape({rows, x.size(1), heads, width}).transpose(1, 2);
    };
    const at::Tensor q = split(query), k = split(key), v = split(value);

    // The computation that is not fused keeps its scores for the backward pass. For Stable
    // Diffusion's 4,096 tokens the scores would take gigabytes.
    constexpr std::int64_t max_scores = 1 << 24;
    const bool small = rows * heads * query.size(1) * key.size(1) <= max_scores;
    at::Tensor result;
    if (needs_gradient && q.is_cpu() && small) {
        const double scale = 1.0 / std::sqrt(static_cast<double>(width));
        at::Tensor scores = at::matmul(q * scale, k.transpose(2, 3));
        if (mask.defined()) scores = scores + mask;
        result = at::matmul(scores.softmax(-1), v);
    } else {
        c10::optional<at::Tensor> bias;
        if (mask.defined()) bias = mask.to(q.scalar_type());
        result = at::scaled_dot_product_attention(q, k, v, bias);
    }
    return result.transpose(1, 2).reshape({rows, query.size(1), channels});
}

}  // namespace item3d
