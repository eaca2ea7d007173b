// The neural texture: position -> material (ITEM3D section 3.2 on Instant-NGP's encoding).
#pragma once

#include "item3d/core/math.h"
#include "item3d/field/hash_grid.h"
#include "item3d/render/shade.h"

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>
#include <torch/types.h>

#include <array>
#include <cstdint>

namespace item3d {

/// What each output may be: {lowest, highest}. Base colour is bounded sRGB-encoded, where equal
/// steps look about equal; the others are the material's own linear values.
struct MaterialRanges {
    std::array<float, 2> base_color{0.0f, 1.0f};
    std::array<float, 2> occlusion{0.0f, 1.0f};
    std::array<float, 2> roughness{0.03f, 1.0f};
    std::array<float, 2> metallic{0.0f, 1.0f};
    /// Largest |x / z| and |y / z| of the tangent-space normal.
    float normal_slope = 1.5f;
};

/// The defaults suit one object with a texture of 1024 pixels; see suggest_field_options (fit.h).
/// Eight levels of four features cost half the look-ups of Instant-NGP's sixteen of two, at the
/// same width and measured quality.
struct NeuralTextureOptions {
    int levels = 6;
    int features = 4;
    int log2_table_size = 17;
    int base_resolution = 16;  ///< cells along the longest edge of the bounds
    int finest_resolution = 1024;
    int hidden_width = 32;
    std::array<Vec3, 2> bounds{Vec3(-1.0f), Vec3(1.0f)};  ///< positions outside are clamped
    MaterialRanges ranges;
    std::uint64_t seed = 0;
};

/// A hash grid and a network with two hidden layers. Parameters: "table", the grid's features with
/// sparse gradients (for Adam of adam.h), and "weight0", "bias0", ... of the network. Made on the
/// CPU; to(device) moves it.
class NeuralTextureImpl : public torch::nn::Module {
  public:
    explicit NeuralTextureImpl(const NeuralTextureOptions& options);

    /// positions [P, 3] world space (first instances', see FieldSpace) -> base colour, orm and
    /// tangent-space normal; emissive and alpha stay undefined. Differentiable in the parameters
    /// and, inside the bounds, in the positions.
    MaterialSample forward(const torch::Tensor& positions);

    /// The same as the network has it, [P, 8]: base colour sRGB-encoded, orm, the normal's x / z
    /// and y / z.
    torch::Tensor encoded(const torch::Tensor& positions);

    const NeuralTextureOptions& options() const { return options_; }
    const torch::Tensor& table() const { return table_; }
    const HashGrid& grid() const { return grid_; }  ///< the table's levels
    /// Weights and biases of the network.
    std::vector<torch::Tensor> network_parameters() const;

    /// A view of the one bias that all metallic values share.
    torch::Tensor metallic_bias() { return biases_.back().detach().select(0, metallic_output); }

  private:
    static constexpr int metallic_output = 5;  ///< after base colour 3, occlusion, roughness

    NeuralTextureOptions options_;
    HashGrid grid_;
    torch::Tensor table_;                 ///< [entries, features]
    std::vector<torch::Tensor> weights_;  ///< [out, in] each
    std::vector<torch::Tensor> biases_;   ///< [out]
    torch::Tensor low_, high_;            ///< [8] ranges of the outputs
    torch::Tensor origin_;                ///< [3] the lower corner of the bounds
};
TORCH_MODULE(NeuralTexture);

/// A copy that training leaves alone, on the same device: what the field was, to compare with what
/// it has become.
NeuralTexture snapshot(const NeuralTexture& field);

}  // namespace item3d
