// Where in a picture a U-Net's cross-attention reads which token of the text.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

/// Sums the attention of layers of all resolutions on one grid, as DAAM does (Tang et al. 2023,
/// "What the DAAM: Interpreting Stable Diffusion Using Cross Attention").
class AttentionMaps {
  public:
    /// The grid that the maps are brought to.
    AttentionMaps(std::int64_t height, std::int64_t width) : height_(height), width_(width) {}

    /// The feature map that the next add() is of.
    void set_layer(std::int64_t height, std::int64_t width) {
        layer_height_ = height;
        layer_width_ = width;
    }
    /// query [N, layer height * width, C], key [N, T, C], both as attention() takes them.
    void add(const at::Tensor& query, const at::Tensor& key, int heads);

    /// [N, T, height, width] float32: mean over heads and layers, 1 in sum over the tokens.
    at::Tensor mean() const;

  private:
    std::int64_t height_, width_;
    std::int64_t layer_height_ = 0, layer_width_ = 0;
    at::Tensor sum_;
    int layers_ = 0;
};

}  // namespace item3d
