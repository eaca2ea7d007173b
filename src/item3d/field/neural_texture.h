// The neural texture: position -> material (ITEM3D section 3.2 on Instant-NGP's encoding).
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

enum class OrmChannel { occlusion, roughness, metallic };

/// A hash grid and a network with two hidden layers. Parameters: "table", the grid's features with
/// sparse gradients (for Adam of adam.h), and "weight0", "bias0", ... of the network. Made on the
/// CPU; to(device) moves it.
class NeuralTextureImpl {
  public:
    explicit NeuralTextureImpl(const NeuralTextureOptions& options);

    /// Moves parameters and ranges.
    void to(at::Device device);
    /// The parameters themselves, as a checkpoint has them: "table", "weight0", "bias0", ...
    NamedTensors named_parameters() const;

    /// positions [P, 3] world space (first instances', see FieldSpace) -> base colour, orm and
    /// tangent-space normal; emissive and alpha stay undefined. Differentiable in the parameters
    /// and, inside the bounds, in the positions.
    MaterialSample forward(const at::Tensor& positions);

    /// The same as the network has it, [P, 8]: base colour sRGB-encoded, orm, the normal's x / z
    /// and y / z.
    at::Tensor encoded(const at::Tensor& positions);

    const NeuralTextureOptions& options() const { return options_; }
    /// Factors [3] of the linear base colour, which stays within 0 .. 1; gradients pass through
    /// both. Not a parameter: it is its owner's to keep.
    void set_base_color_gain(at::Tensor gain) { base_color_gain_ = std::move(gain); }
    const at::Tensor& table() const { return table_; }
    const HashGrid& grid() const { return grid_; }  ///< the table's levels
    /// Weights and biases of the network.
    std::vector<at::Tensor> network_parameters() const;

    /// Views of the last layer's parameters for one output.
    at::Tensor output_weights(OrmChannel channel) {
        return weights_.back().detach().select(0, first_orm + static_cast<int>(channel));
    }
    at::Tensor output_bias(OrmChannel channel) {
        return biases_.back().detach().select(0, first_orm + static_cast<int>(channel));
    }

  private:
    static constexpr int first_orm = 3;  ///< after base colour

    NeuralTextureOptions options_;
    HashGrid grid_;
    at::Tensor table_;                 ///< [entries, features]
    std::vector<at::Tensor> weights_;  ///< [out, in] each
    std::vector<at::Tensor> biases_;   ///< [out]
    at::Tensor low_, high_;            ///< [8] ranges of the outputs
    at::Tensor origin_;                ///< [3] the lower corner of the bounds
    at::Tensor base_color_gain_;       ///< [3]; undefined: 1
};

/// A shared handle of a neural texture: copies are the same texture.
class NeuralTexture {
  public:
    explicit NeuralTexture(const NeuralTextureOptions& options)
        : field_(std::make_shared<NeuralTextureImpl>(options)) {}
    /* implicit */ NeuralTexture(std::nullptr_t) {}  ///< none

    bool is_empty() const { return !field_; }
    NeuralTextureImpl* operator->() const { return field_.get(); }

  private:
    std::shared_ptr<NeuralTextureImpl> field_;
};

/// A copy that training leaves alone, on the same device: what the field was, to compare with what
/// it has become.
NeuralTexture snapshot(const NeuralTexture& field);

}  // namespace item3d
