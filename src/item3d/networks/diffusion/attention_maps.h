// Cross-attention maps of a U-Net: the image region that each text token affects.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

/// Sums the attention of layers of all resolutions on one grid, as DAAM does (Tang et al. 2023,
/// "What the DAAM: Interpreting Stable Diffusion Using Cross Attention").
class AttentionMaps {
  public:
    /// Makes an accumulator for maps of height x width.
    AttentionMaps(std::int64_t height, std::int64_t width) : height_(height), width_(width) {}

    /// Sets the size of the feature map of the next add().
    void set_layer(std::int64_t height, std::int64_t width) {
        layer_height_ = height;
        layer_width_ = width;
    }
    /// Adds one layer's attention. query is [N, layer height * layer width, C] and key [N, T, C],
    /// as for attention().
    void add(const at::Tensor& query, const at::Tensor& key, int heads);

    /// Returns the mean over heads and layers, [N, T, height, width] float32; it sums to 1 over
    /// tokens.
    at::Tensor mean() const;

  private:
    std::int64_t height_, width_;
    std::int64_t layer_height_ = 0, layer_width_ = 0;
    at::Tensor sum_;
    int layers_ = 0;
};

}  // namespace item3d
