#include "item3d/networks/diffusion/attention_maps.h"

#include "item3d/core/error.h"

#include <cmath>

namespace item3d {

void AttentionMaps::add(const at::Tensor& query, const at::Tensor& key, int heads) {
    const at::NoGradGuard no_grad;
    const std::int64_t rows = query.size(0), tokens = key.size(1), width = query.size(2) / heads;
    ITEM3D_CHECK(query.size(1) == layer_height_ * layer_width_, "a layer of another size");
    const auto split = [&](const at::Tensor& x) {  // [N, S, C] -> [N, heads, S, d]
        return x.to(at::kFloat).reshape({rows, x.size(1), heads, width}).transpose(1, 2);
    };
    const double scale = 1.0 / std::sqrt(static_cast<double>(width));
    const at::Tensor weights =
        at::matmul(split(query) * scale, split(key).transpose(2, 3)).softmax(-1).mean(1);
    at::Tensor map = weights.transpose(1, 2).reshape({rows, tokens, layer_height_, layer_width_});
    if (layer_height_ != height_ || layer_width_ != width_)
        map = at::upsample_bilinear2d(map, {height_, width_}, false);
    sum_ = sum_.defined() ? sum_ + map : map;
    ++layers_;
}

at::Tensor AttentionMaps::mean() const {
    ITEM3D_CHECK(layers_ > 0, "no layer attended to the text");
    return sum_ / layers_;
}

}  // namespace item3d
