// The neural texture, which maps a position to a material (ITEM3D section 3.2, with Instant-NGP's
// encoding).
#pragma once

#include "item3d/core/math.h"
#include "item3d/field/hash_grid.h"
#include "item3d/render/shade.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Ranges of the outputs, {lowest, highest}. Base colour is bounded in sRGB encoding, which is
/// roughly perceptually uniform. The other outputs are the material's own linear values.
struct MaterialRanges {
    std::array<float, 2> base_color{0.0f, 1.0f};
    std::array<float, 2> occlusion{0.0f, 1.0f};
    std::array<float, 2> roughness{0.03f, 1.0f};
    std::array<float, 2> metallic{0.0f, 1.0f};
    /// Largest |x / z| and |y / z| of the tangent-space normal.
    float normal_slope = 1.5f;
};

/// Options of a neural texture. The defaults suit one object with a texture of 1024 pixels;
/// suggest_field_options() (fit.h) adapts them to a surface. Six levels of four features need fewer
/// lookups than Instant-NGP's sixteen levels of two features.
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

enum class OrmChannel { occlusion, roughness, metallic };

/// A hash grid and a network with two hidden layers. The parameters are "table", which has the
/// grid's features and sparse gradients (adam.h), and "weight0", "bias0", ... of the network. A new
/// neural texture is on the CPU; to() moves it.
class NeuralTextureImpl {
  public:
    explicit NeuralTextureImpl(const NeuralTextureOptions& options);

    /// Moves the parameters and ranges to a device.
    void to(at::Device device);
    /// Returns the parameters themselves, in a checkpoint's order: "table", "weight0", "bias0", ...
    NamedTensors named_parameters() const;

    /// Maps positions [P, 3], from FieldSpace::positions(), to base colour, orm and tangent-space
    /// normal; emissive and alpha stay undefined. Differentiable in the parameters and, inside the
    /// bounds, in the positions.
    MaterialSample forward(const at::Tensor& positions);

    /// Returns the values of forward() in the network's encoding, [P, 8]. They are the sRGB-encoded
    /// base colour, orm, and x / z and y / z of the normal.
    at::Tensor encoded(const at::Tensor& positions);

    const NeuralTextureOptions& options() const { return options_; }
    /// Sets factors [3] of the linear base colour; the product is clamped to [0, 1]. Gradients pass
    /// through the factors and the clamp. The factors are not among the parameters; the caller
    /// keeps them.
    void set_base_color_gain(at::Tensor gain) { base_color_gain_ = std::move(gain); }
    const at::Tensor& table() const { return table_; }
    const HashGrid& grid() const { return grid_; }  ///< levels of the table
    /// Returns the weights and biases of the network.
    std::vector<at::Tensor> network_parameters() const;

    /// output_weights() and output_bias() return views of the last layer's parameters for one
    /// output.
    at::Tensor output_weights(OrmChannel channel) {
        return weights_.back().detach().select(0, first_orm + static_cast<int>(channel));
    }
    at::Tensor output_bias(OrmChannel channel) {
        return biases_.back().detach().select(0, first_orm + static_cast<int>(channel));
    }

  private:
    static constexpr int first_orm = 3;  ///< index of occlusion, which follows base colour

    NeuralTextureOptions options_;
    HashGrid grid_;
    at::Tensor table_;                 ///< [entries, features]
    std::vector<at::Tensor> weights_;  ///< [out, in] each
    std::vector<at::Tensor> biases_;   ///< [out]
    at::Tensor low_, high_;            ///< [8] output ranges
    at::Tensor origin_;                ///< [3] lower corner of the bounds
    at::Tensor base_color_gain_;       ///< [3]; if undefined, the factors are 1
};

/// A shared handle of a neural texture. Copies refer to the same neural texture.
class NeuralTexture {
  public:
    explicit NeuralTexture(const NeuralTextureOptions& options)
        : field_(std::make_shared<NeuralTextureImpl>(options)) {}
    /* implicit */ NeuralTexture(std::nullptr_t) {}  ///< an empty handle

    bool is_empty() const { return !field_; }
    NeuralTextureImpl* operator->() const { return field_.get(); }

  private:
    std::shared_ptr<NeuralTextureImpl> field_;
};

/// Returns a copy of the field on the same device. Training the field does not change the copy.
NeuralTexture snapshot(const NeuralTexture& field);

}  // namespace item3d
