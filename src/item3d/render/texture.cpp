#include "item3d/render/texture.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/texture.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using kernels::TextureParameters;
using kernels::TextureWrap;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

TextureWrap kernel_wrap(Wrap wrap) {
    switch (wrap) {
        case Wrap::mirrored_repeat:
            return TextureWrap::mirrored_repeat;
        case Wrap::clamp_to_edge:
            return TextureWrap::clamp_to_edge;
        default:
            return TextureWrap::repeat;
    }
}

/// Non-differentiable inputs.
struct SampleSettings {
    at::Tensor footprint;  ///< [P, 4] or undefined
    TextureWrap wrap_u, wrap_v;
    bool nearest;
};

/// inputs: UV, then the levels.
TextureParameters texture_parameters(const tensor_list& inputs, const SampleSettings& settings) {
    TextureParameters p{};
    p.uv = inputs[0].const_data_ptr<float>();
    p.footprint =
        settings.footprint.defined() ? settings.footprint.const_data_ptr<float>() : nullptr;
    p.wrap_u = settings.wrap_u;
    p.wrap_v = settings.wrap_v;
    p.nearest = settings.nearest;
    p.level_count = static_cast<int>(inputs.size()) - 1;
    p.channels = static_cast<int>(inputs[1].size(2));
    std::int64_t first = 0;
    for (std::size_t i = 1; i < inputs.size(); ++i) {
        p.levels[i - 1] = {inputs[i].const_data_ptr<float>(), static_cast<int>(inputs[i].size(0)),
                           static_cast<int>(inputs[i].size(1)), first};
        first += inputs[i].numel();
    }
    return p;
}

/// Returns the concatenated gradients [total] of all levels.
at::Tensor texel_gradient(const TextureParameters& p, const float* value_gradient,
                          std::int64_t count, std::int64_t total) {
    const at::Tensor gradient = at::zeros({total});
    Accumulator sums;
    sums.values = gradient.data_ptr<float>();
    // One thread adds all gradients, so that the sums are reproducible. Summing the buffers of
    // several threads would cost more.
    for (std::int64_t i = 0; i < count; ++i)
        kernels::texture_backward(p, i, value_gradient, sums);
    return gradient;
}

at::Tensor texel_gradient_on_cuda(const TextureParameters& p, const float* value_gradient,
                                  std::int64_t count, std::int64_t total, at::Device device) {
    // In a level of one texel, all four taps of every probe add to the same sum.
    const std::int64_t max_terms = 4 * kernels::max_texture_probes * count;
    return cuda::sum_on_device(total, max_terms, device, [&](const Accumulator& sums) {
        cuda::run(cuda::render_table().texture_backward,
                  {p, nullptr, value_gradient, nullptr, sums}, count, device);
    });
}

struct SampleTexture : torch::autograd::Function<SampleTexture> {
    static at::Tensor forward(AutogradContext* context, at::TensorList inputs_,
                              const SampleSettings& settings) {
        const tensor_list inputs = inputs_.vec();
        const std::int64_t count = inputs[0].size(0);
        at::Tensor values = at::empty({count, inputs[1].size(2)}, inputs[0].options());
        float* out = values.data_ptr<float>();
        const TextureParameters p = texture_parameters(inputs, settings);
        if (values.is_cuda())
            cuda::run(cuda::render_table().texture, {p, out, nullptr, nullptr, {}}, count,
                      values.device());
        else
            parallel_for(
                "sample_texture", count,
                [&p, out](std::int64_t i) { kernels::texture_forward(p, i, out); }, 4096);
        tensor_list saved = inputs;
        saved.push_back(settings.footprint);
        context->save_for_backward(saved);
        context->saved_data["wrap_u"] = static_cast<std::int64_t>(settings.wrap_u);
        context->saved_data["wrap_v"] = static_cast<std::int64_t>(settings.wrap_v);
        context->saved_data["nearest"] = settings.nearest;
        return values;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        tensor_list inputs = context->get_saved_variables();
        const SampleSettings settings{
            inputs.back(), static_cast<TextureWrap>(context->saved_data["wrap_u"].toInt()),
            static_cast<TextureWrap>(context->saved_data["wrap_v"].toInt()),
            context->saved_data["nearest"].toBool()};
        inputs.pop_back();
        const TextureParameters p = texture_parameters(inputs, settings);
        const at::Tensor gradient = gradients[0].contiguous();
        const float* in = gradient.const_data_ptr<float>();
        const std::int64_t count = inputs[0].size(0);
        const at::Device device = gradient.device();
        tensor_list results(inputs.size() + 1);
        if (context->needs_input_grad(0)) {
            results[0] = at::empty_like(inputs[0]);
            float* out = results[0].data_ptr<float>();
            if (device.is_cuda())
                cuda::run(cuda::render_table().texture_uv_backward, {p, nullptr, in, out, {}},
                          count, device);
            else
                parallel_for(
                    "sample_texture by uv", count,
                    [&p, in, out](std::int64_t i) { kernels::texture_uv_backward(p, i, in, out); },
                    4096);
        }
        bool texels = false;
        for (std::size_t i = 1; i < inputs.size(); ++i)
            texels = texels || context->needs_input_grad(i);
        if (!texels) return results;
        std::int64_t total = 0;
        for (std::size_t i = 1; i < inputs.size(); ++i)
            total += inputs[i].numel();
        const at::Tensor by_texels = device.is_cuda()
                                         ? texel_gradient_on_cuda(p, in, count, total, device)
                                         : texel_gradient(p, in, count, total);
        for (std::size_t i = 1; i < inputs.size(); ++i)
            results[i] =
                by_texels.narrow(0, p.levels[i - 1].first, inputs[i].numel()).view_as(inputs[i]);
        return results;
    }
};

/// Maps [2H, 2W, C] to [H, W, C]; a texel is the mean of 2 x 2 texels.
struct HalveTexture : torch::autograd::Function<HalveTexture> {
    static at::Tensor forward(AutogradContext*, const at::Tensor& fine) {
        at::Tensor coarse =
            at::empty({fine.size(0) / 2, fine.size(1) / 2, fine.size(2)}, fine.options());
        const kernels::HalveParameters p{fine.const_data_ptr<float>(),
                                         static_cast<int>(fine.size(1)),
                                         static_cast<int>(fine.size(2)), coarse.data_ptr<float>()};
        const std::int64_t count = coarse.size(0) * coarse.size(1);
        dispatch<kernels::halve_texture>(fine.device(), "halve_texture",
                                         &cuda::RenderTable::halve_texture, p, count, 16384);
        return coarse;
    }
    static tensor_list backward(AutogradContext*, tensor_list gradients) {
        const at::Tensor coarse = gradients[0].contiguous();
        at::Tensor fine =
            at::empty({2 * coarse.size(0), 2 * coarse.size(1), coarse.size(2)}, coarse.options());
        const kernels::HalveParameters p{coarse.const_data_ptr<float>(),
                                         static_cast<int>(fine.size(1)),
                                         static_cast<int>(fine.size(2)), fine.data_ptr<float>()};
        const std::int64_t count = coarse.size(0) * coarse.size(1);
        dispatch<kernels::halve_texture_backward>(fine.device(), "halve_texture backward",
                                                  &cuda::RenderTable::halve_texture_backward, p,
                                                  count, 16384);
        return {fine};
    }
};

}  // namespace

std::vector<at::Tensor> texture_pyramid(const at::Tensor& texture) {
    std::vector<at::Tensor> levels{texture.contiguous()};
    while (levels.size() < kernels::max_texture_levels &&
           std::max(levels.back().size(0), levels.back().size(1)) > 1) {
        const at::Tensor& fine = levels.back();
        const std::int64_t height = std::max<std::int64_t>(1, fine.size(0) / 2);
        const std::int64_t width = std::max<std::int64_t>(1, fine.size(1) / 2);
        if (fine.size(0) == 2 * height && fine.size(1) == 2 * width) {
            levels.push_back(HalveTexture::apply(fine));
            continue;
        }
        const at::Tensor planes = fine.permute({2, 0, 1}).unsqueeze(0);
        const at::Tensor coarse = at::adaptive_avg_pool2d(planes, {height, width});
        levels.push_back(coarse.squeeze(0).permute({1, 2, 0}).contiguous());
    }
    return levels;
}

at::Tensor sample_texture(const std::vector<at::Tensor>& levels, const at::Tensor& uv_,
                          const at::Tensor& footprint, Wrap wrap_u, Wrap wrap_v, bool nearest) {
    constexpr const char* op = "sample_texture";
    ITEM3D_CHECK(!levels.empty() && levels.size() <= kernels::max_texture_levels &&
                     levels[0].dim() == 3 && levels[0].numel() > 0,
                 "sample_texture: 1 to 16 levels of a texture [H, W, C] with texels");
    const at::Device device = operation_device(op, uv_);
    tensor_list inputs{checked(op, "uv", uv_, at::kFloat, {-1, 2}, device)};
    for (const at::Tensor& level : levels)
        inputs.push_back(
            checked(op, "texture", level, at::kFloat, {-1, -1, levels[0].size(2)}, device));
    SampleSettings settings{{}, kernel_wrap(wrap_u), kernel_wrap(wrap_v), nearest};
    if (footprint.defined())
        settings.footprint = checked(op, "footprint", footprint.detach(), at::kFloat,
                                     {inputs[0].size(0), 4}, device);
    return SampleTexture::apply(at::TensorList(inputs), settings);
}

at::Tensor sample_texture(const at::Tensor& texture, const at::Tensor& uv, Wrap wrap_u, Wrap wrap_v,
                          bool nearest) {
    return sample_texture(std::vector<at::Tensor>{texture}, uv, {}, wrap_u, wrap_v, nearest);
}

}  // namespace item3d
