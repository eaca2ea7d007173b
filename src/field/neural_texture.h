// The neural texture: object-space position -> material (ITEM3D section 3.2, Instant-NGP's encoding).
#pragma once

#include <torch/torch.h>

#include "item3d/core/random.h"
#include "item3d/render/shade.h"
#include "item3d/scene/model.h"

namespace item3d {

/// What the field's outputs may be; sigmoid outputs are mapped into [low, high] by channel.
struct MaterialRanges {
    std::array<float, 3> base_color{0.0f, 1.0f, 0.0f};  // see field docs; low, high, unused
    std::array<float, 2> occlusion{0.0f, 1.0f};
    std::array<float, 2> roughness{0.05f, 1.0f};
    std::array<float, 2> metallic{0.0f, 1.0f};
};

struct NeuralTextureOptions {
    int levels = 16;
    int features = 2;
    int log2_table_size = 19;
    int base_resolution = 16;
    int finest_resolution = 4096;
    int hidden_width = 32;
    std::array<Vec3, 2> bounds{Vec3(-1), Vec3(1)};  ///< positions outside are clamped
    std::uint64_t seed = 0;
};

/// A multi-resolution hash grid (Mueller et al. 2022) and a two-hidden-layer MLP.
class NeuralTextureImpl : public torch::nn::Module {
  public:
    explicit NeuralTextureImpl(const NeuralTextureOptions& options);
    /// positions [P, 3] world space -> material; `normal` is tangent space.
    MaterialSample forward(const torch::Tensor& positions);

    const NeuralTextureOptions& options() const { return options_; }

  private:
    NeuralTextureOptions options_;
    torch::Tensor table_;
    torch::nn::Sequential mlp_{nullptr};
};
TORCH_MODULE(NeuralTexture);

}  // namespace item3d
