#include "item3d/field/neural_texture.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"

#include <torch/csrc/autograd/custom_function.h>

#include <cmath>

namespace item3d {
namespace {

constexpr int output_width = 8;  // base colour 3, orm 3, normal's x and y
/// How far the sigmoid overshoots each end of a range before the clamp. Black and white lie on its
/// slope instead of at its infinite ends, so an edit can leave them again.
constexpr float overshoot = 0.05f;

constexpr float awake = 0.5f;  ///< bound of hidden units' first biases

/// Clamps the value and lets the gradient through.
class ClampValue : public torch::autograd::Function<ClampValue> {
  public:
    static torch::Tensor forward(torch::autograd::AutogradContext*, const torch::Tensor& value,
                                 const torch::Tensor& low, const torch::Tensor& high) {
        return torch::clamp(value, low, high);
    }
    static torch::autograd::variable_list backward(torch::autograd::AutogradContext*,
                                                   torch::autograd::variable_list grads) {
        return {grads[0], torch::Tensor(), torch::Tensor()};
    }
};

torch::Tensor uniform_tensor(std::vector<std::int64_t> shape, float bound, Random& random) {
    torch::Tensor tensor = torch::empty(shape, torch::kFloat32);
    float* data = tensor.data_ptr<float>();
    for (std::int64_t i = 0; i < tensor.numel(); ++i) {
        data[i] = static_cast<float>(random.uniform(-bound, bound));
    }
    return tensor;
}

}  // namespace

NeuralTextureImpl::NeuralTextureImpl(const NeuralTextureOptions& options)
    : options_(options),
      grid_(HashGrid::make(options.levels, options.features, options.log2_table_size,
                           options.base_resolution, options.finest_resolution)) {
    Random random(options.seed, 0x6669656c64);
    table_ = register_parameter("table",
                                uniform_tensor({grid_.entries(), grid_.features}, 1e-4f, random));
    const std::array<int, 4> widths{grid_.output_width(), options.hidden_width,
                                    options.hidden_width, output_width};
    for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
        const bool last = i + 2 == widths.size();
        const float bound = std::sqrt((last ? 1.0f : 6.0f) / widths[i]);
        weights_.push_back(
            register_parameter("weight" + std::to_string(i),
                               uniform_tensor({widths[i + 1], widths[i]}, bound, random)));
        // Hidden units are awake where the table is empty, so that a plain surface's colour can
        // change by the network's weights: by the last biases alone it would take far longer.
        biases_.push_back(
            register_parameter("bias" + std::to_string(i),
                               uniform_tensor({widths[i + 1]}, last ? 0.0f : awake, random)));
    }
    const MaterialRanges& r = options.ranges;
    const float slope = r.normal_slope;
    low_ = register_buffer(
        "low", torch::tensor({r.base_color[0], r.base_color[0], r.base_color[0], r.occlusion[0],
                              r.roughness[0], r.metallic[0], -slope, -slope}));
    high_ = register_buffer(
        "high", torch::tensor({r.base_color[1], r.base_color[1], r.base_color[1], r.occlusion[1],
                               r.roughness[1], r.metallic[1], slope, slope}));
    const Vec3 origin = options.bounds[0];
    origin_ = register_buffer("origin", torch::tensor({origin.x, origin.y, origin.z}));
    ITEM3D_CHECK(torch::all(high_ >= low_).item<bool>(), "a material range is empty");
}

torch::Tensor NeuralTextureImpl::encoded(const torch::Tensor& positions) {
    const Vec3 size = options_.bounds[1] - options_.bounds[0];
    // One scale for all axes: cells are cubes.
    const float extent = std::max({size.x, size.y, size.z, 1e-20f});
    const torch::Tensor points = (positions - origin_) * (1.0f / extent);
    torch::Tensor x = encode(grid_, points, table_);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        x = torch::linear(x, weights_[i], biases_[i]);
        if (i + 1 < weights_.size()) x = torch::relu(x);
    }
    const torch::Tensor span = high_ - low_;
    const torch::Tensor wide = torch::addcmul(low_ - overshoot * span, torch::sigmoid(x),
                                              (1.0f + 2.0f * overshoot) * span);
    return ClampValue::apply(wide, low_, high_);
}

MaterialSample NeuralTextureImpl::forward(const torch::Tensor& positions) {
    const torch::Tensor values = encoded(positions);
    MaterialSample sample;
    sample.base_color = srgb_to_linear(values.narrow(1, 0, 3));
    sample.orm = values.narrow(1, 3, 3);
    const torch::Tensor tangent = values.narrow(1, 6, 2);
    const torch::Tensor normal =
        torch::cat({tangent, torch::ones_like(tangent.narrow(1, 0, 1))}, 1);
    sample.normal = normal * torch::rsqrt(normal.square().sum(1, true));
    return sample;
}

std::vector<torch::Tensor> NeuralTextureImpl::network_parameters() const {
    std::vector<torch::Tensor> all = weights_;
    all.insert(all.end(), biases_.begin(), biases_.end());
    return all;
}

NeuralTexture snapshot(const NeuralTexture& field) {
    const torch::NoGradGuard no_grad;
    NeuralTexture copy(field->options());
    copy->to(field->table().device());
    auto targets = copy->named_parameters();
    for (const auto& source : field->named_parameters()) {
        targets[source.key()].copy_(source.value());
        targets[source.key()].set_requires_grad(false);
    }
    return copy;
}

}  // namespace item3d
