#include "item3d/field/neural_texture.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/core/random.h"
#include "item3d/field/cuda/module.h"
#include "item3d/field/kernels/bounded.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"

#include <torch/csrc/autograd/custom_function.h>

#include <cmath>

namespace item3d {
namespace {

constexpr int output_width = 8;  // base colour 3, orm 3, normal's x and y
constexpr float awake = 0.5f;    ///< bound of the hidden layers' initial biases

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

constexpr std::int64_t bounded_grain = 4096;

/// Maps x [P, N] to values in the ranges low .. high [N] (kernels/bounded.h).
struct Bounded : torch::autograd::Function<Bounded> {
    static void run(const BoundedParameters& p, const at::Tensor& x) {
        const bool back = p.gradient != nullptr;
        if (x.is_cuda()) {
            const cuda::FieldTable& table = cuda::field_table();
            cuda::run(back ? table.bounded_backward : table.bounded, p, x.numel(), x.device());
        } else if (back) {
            parallel_for(
                "bounded backward", x.numel(), [=](std::int64_t i) { bounded_backward(p, i); },
                bounded_grain);
        } else {
            parallel_for(
                "bounded", x.numel(), [=](std::int64_t i) { bounded_forward(p, i); },
                bounded_grain);
        }
    }
    static at::Tensor forward(AutogradContext* context, const at::Tensor& x_, const at::Tensor& low,
                              const at::Tensor& high) {
        const at::Tensor x = x_.contiguous(), out = at::empty_like(x);
        run({x.const_data_ptr<float>(), low.const_data_ptr<float>(), high.const_data_ptr<float>(),
             nullptr, x.size(1), out.data_ptr<float>()},
            x);
        context->save_for_backward({x, low, high});
        return out;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const tensor_list saved = context->get_saved_variables();
        const at::Tensor& x = saved[0];
        const at::Tensor gradient = gradients[0].contiguous(), out = at::empty_like(x);
        run({x.const_data_ptr<float>(), saved[1].const_data_ptr<float>(),
             saved[2].const_data_ptr<float>(), gradient.const_data_ptr<float>(), x.size(1),
             out.data_ptr<float>()},
            x);
        return {out, at::Tensor(), at::Tensor()};
    }
};

at::Tensor uniform_tensor(std::vector<std::int64_t> shape, float bound, Random& random) {
    at::Tensor tensor = at::empty(shape, at::kFloat);
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
    Random random(options.seed, RandomStream::field);
    table_ = uniform_tensor({grid_.entries(), grid_.features}, 1e-4f, random);
    const std::array<int, 4> widths{grid_.output_width(), options.hidden_width,
                                    options.hidden_width, output_width};
    for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
        const bool last = i + 2 == widths.size();
        const float bound = std::sqrt((last ? 1.0f : 6.0f) / widths[i]);
        weights_.push_back(uniform_tensor({widths[i + 1], widths[i]}, bound, random));
        // These biases keep hidden units active where the table's features are near 0. The colour
        // of a plain surface can then change by the network's weights. By the biases of the last
        // layer alone it would change far more slowly.
        biases_.push_back(uniform_tensor({widths[i + 1]}, last ? 0.0f : awake, random));
    }
    const MaterialRanges& r = options.ranges;
    const float slope = r.normal_slope;
    low_ = at::tensor({r.base_color[0], r.base_color[0], r.base_color[0], r.occlusion[0],
                       r.roughness[0], r.metallic[0], -slope, -slope});
    high_ = at::tensor({r.base_color[1], r.base_color[1], r.base_color[1], r.occlusion[1],
                        r.roughness[1], r.metallic[1], slope, slope});
    const Vec3 origin = options.bounds[0];
    origin_ = at::tensor({origin.x, origin.y, origin.z});
    ITEM3D_CHECK(at::all(high_ >= low_).item<bool>(), "a material range is empty");
    for (const auto& [name, parameter] : named_parameters())
        parameter.requires_grad_(true);
}

void NeuralTextureImpl::to(at::Device device) {
    for (const auto& [name, parameter] : named_parameters())
        parameter.set_data(parameter.to(device));
    for (at::Tensor* constant : {&low_, &high_, &origin_})
        *constant = constant->to(device);
}

NamedTensors NeuralTextureImpl::named_parameters() const {
    NamedTensors named{{"table", table_}};
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        named.emplace_back("weight" + std::to_string(i), weights_[i]);
        named.emplace_back("bias" + std::to_string(i), biases_[i]);
    }
    return named;
}

at::Tensor NeuralTextureImpl::encoded(const at::Tensor& positions) {
    const Vec3 size = options_.bounds[1] - options_.bounds[0];
    // All axes have the same scale, so that cells are cubes.
    const float extent = std::max({size.x, size.y, size.z, 1e-20f});
    const at::Tensor points = (positions - origin_) * (1.0f / extent);
    at::Tensor x = encode(grid_, points, table_);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        x = at::linear(x, weights_[i], biases_[i]);
        if (i + 1 < weights_.size()) x = at::relu(x);
    }
    return Bounded::apply(x, low_, high_);
}

MaterialSample NeuralTextureImpl::forward(const at::Tensor& positions) {
    const at::Tensor values = encoded(positions);
    MaterialSample sample;
    sample.base_color = srgb_to_linear(values.narrow(1, 0, 3));
    if (base_color_gain_.defined()) {
        // The gradient passes through the clamp at 1.
        const at::Tensor scaled = sample.base_color * base_color_gain_;
        sample.base_color = scaled - (scaled - scaled.clamp_max(1.0f)).detach();
    }
    sample.orm = values.narrow(1, 3, 3);
    const at::Tensor tangent = values.narrow(1, 6, 2);
    const at::Tensor normal = at::cat({tangent, at::ones_like(tangent.narrow(1, 0, 1))}, 1);
    sample.normal = normal * at::rsqrt(normal.square().sum(1, true));
    return sample;
}

std::vector<at::Tensor> NeuralTextureImpl::network_parameters() const {
    std::vector<at::Tensor> all = weights_;
    all.insert(all.end(), biases_.begin(), biases_.end());
    return all;
}

NeuralTexture snapshot(const NeuralTexture& field) {
    const at::NoGradGuard no_grad;
    NeuralTexture copy(field->options());
    copy->to(field->table().device());
    const NamedTensors sources = field->named_parameters();
    const NamedTensors targets = copy->named_parameters();
    for (std::size_t i = 0; i < sources.size(); ++i)
        targets[i].second.copy_(sources[i].second).set_requires_grad(false);
    return copy;
}

}  // namespace item3d
